# The tests of linear algebra without vector instructions, and with the LAPACK of a library where there is one.
. tests/check/common.sh

attempt variants-plain make -s test BUILD=build/plain CFLAGS="-O1 -DYC_NO_SIMD" TESTS="dense sparse direct"

printf '%s\n' 'void dgetrf_(int *, int *, double *, int *, int *, int *);' \
    'int main(void) { int n = 0, i; dgetrf_(&n, &n, 0, &n, 0, &i); return 0; }' >"$work/probe.c"
if "$CC" "$work/probe.c" -o "$work/probe" -llapack -lblas 2>/dev/null; then
    # not dense: those tests look into the LU factor
    attempt variants-lapack make -s test BUILD=build/lapack CFLAGS='-O1 -DYC_USE_LAPACK' \
        LIBRARIES='-llapack -lblas' TESTS="sparse direct"
else
    echo "skip variants-lapack: no LAPACK here"
fi
