# CUDA's compiler accepts the implementation, so that kernels may call its element functions. Skipped where there is
# none.
. tests/check/common.sh
CHECK_STRICT=0
need nvcc cuda

implementation >"$work/unit.cu"
attempt cuda nvcc -std=c++17 -I. -c "$work/unit.cu" -o "$work/unit.o"
