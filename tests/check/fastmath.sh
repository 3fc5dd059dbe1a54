# The implementation refuses -ffast-math by its own #error, and nothing else stands in the way.
. tests/check/common.sh

implementation >"$work/unit.c"
attempt fastmath-without-it "$CC" -std=c99 -I. -fsyntax-only "$work/unit.c" || exit 0
if "$CC" -std=c99 -ffast-math -I. -fsyntax-only "$work/unit.c" >"$work/log" 2>&1; then
    echo "it compiles with -ffast-math" >"$work/complaints"
elif grep -E '#error|error:' "$work/log" | grep -q 'fast-math'; then
    : >"$work/complaints"
else
    echo "no #error that names -ffast-math: $(grep -m 1 error "$work/log")" >"$work/complaints"
fi
verdict fastmath-refused "$work/complaints"
