# The tests of linear algebra without vector instructions, and with the LAPACK of a library where there is one.
. tests/check/common.sh

algebra='tests/main.c tests/test_linalg.c tests/test_direct.c'
attempt variants-plain make -s test BUILD=build/plain CFLAGS='-O1 -DYC_NO_SIMD' TEST_SOURCES="$algebra"

printf '%s\n' 'void dgetrf_(int *, int *, double *, int *, int *, int *);' \
    'int main(void) { int n = 0, i; dgetrf_(&n, &n, 0, &n, 0, &i); return 0; }' >"$work/probe.c"
if "$CC" "$work/probe.c" -o "$work/probe" -llapack -lblas 2>/dev/null; then
    # not dense: those tests look into the LU factor
    attempt variants-lapack make -s test BUILD=build/lapack CFLAGS='-O1 -DYC_USE_LAPACK' \
        LIBRARIES='-llapack -lblas' TEST_SOURCES="$algebra" TESTS='sparse direct'
else
    echo "skip variants-lapack: no LAPACK here"
fi
