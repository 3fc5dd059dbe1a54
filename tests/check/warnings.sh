# Not one warning, from two compilers in four dialects, optimized in C99: the header alone, with its implementation, and
# included twice in each of two units of one program. Then C implementation with C++ caller, and the examples and tests
# themselves.
. tests/check/common.sh

printf '%s\n' '#include "yarncloth.h"' '#include "yarncloth.h"' >"$work/header.c"
{ echo '#include "yarncloth.h"'; implementation; echo '#include "yarncloth.h"'; } >"$work/unit.c"
{ cat "$work/header.c"; echo 'int main(void) { return yc_version() ? 0 : 1; }'; } >"$work/main.c"
for name in header unit main; do cp "$work/$name.c" "$work/$name.cpp"; done

# dialect COMPILER STANDARD SUFFIX [OPTION]
dialect() {
    name=$(basename "$1")-$2
    out=$work/$name
    attempt "warnings-$name-header" "$1" -std="$2" $warnings -I. -c "$work/header.$3" -o "$out.header.o"
    attempt "warnings-$name-implementation" "$1" -std="$2" ${4:-} $warnings -I. -c "$work/unit.$3" -o "$out.unit.o" || return
    "$1" -std="$2" $warnings -I. -c "$work/main.$3" -o "$out.main.o" 2>"$out.main.log" &&
        attempt "warnings-$name-program" "$1" "$out.main.o" "$out.unit.o" -o "$out.program" -lm && return
    [ ! -s "$out.main.log" ] || failed "warnings-$name-program" "$(grep -m 1 error "$out.main.log")"
}

for pair in gcc:g++ clang:clang++; do
    c=${pair%:*} cxx=${pair#*:}
    (need "$c" "warnings-$c" && dialect "$c" c99 c -O2 && dialect "$c" c11 c)
    (need "$cxx" "warnings-$cxx" && dialect "$cxx" c++11 cpp && dialect "$cxx" c++20 cpp)
done

(need gcc warnings-mixed && need g++ warnings-mixed && [ -f "$work/gcc-c99.unit.o" ] &&
    attempt warnings-mixed-c-and-c++ g++ $warnings -I. "$work/main.cpp" "$work/gcc-c99.unit.o" -o "$work/mixed" -lm)

for c in gcc clang; do
    (need "$c" "warnings-$c-own"
     printf '%s\n' 'ENTRY(nothing)' >"$work/tests.inc"
     attempt "warnings-$c-examples-and-tests" "$c" -std=c99 $warnings -I. -I"$work" -DTEST_THREADS -fsyntax-only $(sources | grep '\.c$'))
done
