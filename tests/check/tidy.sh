# clang-tidy, by .clang-tidy, over the implementation and over examples and tests.
. tests/check/common.sh
need clang-tidy tidy

# tidy NAME FLAGS FILE...
tidy() {
    name=$1 flags=$2 && shift 2
    clang-tidy --quiet "$@" -- -std=c99 $flags >"$work/$name.log" 2>&1 </dev/null
    status=$?
    grep -E '(error|warning): ' "$work/$name.log" | sort -u >"$work/$name.complaints"
    [ $status = 0 ] || [ -s "$work/$name.complaints" ] || cp "$work/$name.log" "$work/$name.complaints"
    verdict "$name" "$work/$name.complaints"
}
echo 'ENTRY(nothing)' >"$work/tests.inc"
# The header as the main file: what is merely included is not analysed.
tidy tidy-implementation '-x c -DYARNCLOTH_IMPLEMENTATION' yarncloth.h
tidy tidy-examples-and-tests "-I. -I$work -DTEST_THREADS" $(sources | grep '\.c$' | xargs grep -L -E 'internals\.h|YARNCLOTH_IMPLEMENTATION')
