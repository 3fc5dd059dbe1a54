# What the library leaves in a program: functions named yc_, macros named YC_ or YARNCLOTH, no variables, nothing that
# prints, aborts or opens files. With YC_API static it leaves nothing at all.
. tests/check/common.sh
need nm symbols

implementation >"$work/unit.c"
{ echo '#define YC_API static'; implementation; } >"$work/static.c"
# Without position-independent code, tables of constant pointers count as the constants they are.
attempt symbols-compiles "$CC" -std=c99 -O2 -fno-pic -I. -c "$work/unit.c" -o "$work/unit.o" || exit 0
attempt symbols-static-compiles "$CC" -std=c99 -O2 -Wno-unused-function -I. -c "$work/static.c" -o "$work/static.o" || exit 0

nm -g "$work/unit.o" | awk '$(NF - 1) != "U" { print $NF }' | sed 's/^_yc_/yc_/' >"$work/globals"
{ [ -s "$work/globals" ] || echo "no global symbol at all"; grep -v '^yc_' "$work/globals"; } >"$work/unprefixed"
verdict symbols-global "$work/unprefixed"

nm -g "$work/static.o" | awk '$(NF - 1) != "U" { print $NF " is global in spite of YC_API static" }' >"$work/leaked"
verdict symbols-static "$work/leaked"

nm "$work/unit.o" | awk '$(NF - 1) ~ /^[bBdDcCgGsS]$/ { print $NF " is a variable: constant tables are const throughout" }' >"$work/variables"
verdict symbols-no-variables "$work/variables"

nm -u "$work/unit.o" | awk '{ print $NF }' |
    grep -xE '_?_?_?(v?f?printf|puts|fputs|putchar|fputc|fwrite|fopen|fread|abort|exit|_exit|assert_fail|stdout|stderr|stdin|getenv|system|s?rand|setlocale)(_chk)?' |
    sed 's/$/ is called/' >"$work/forbidden"
verdict symbols-silent "$work/forbidden"

# macros NAME FILE PATTERN: what a unit defines beyond the standard headers that yarncloth.h includes begins with
# PATTERN.
sed -n 's/^[ \t]*#[ \t]*include[ \t]*<\(.*\)>.*/\1/p' yarncloth.h | grep -E '^(assert|ctype|errno|float|inttypes|limits|math|setjmp|signal|std[a-z]*|string|time)\.h$' |
    sort -u | sed 's/.*/#include <&>/' >"$work/standard.c"
grep -q 'include <immintrin.h>' yarncloth.h && printf '#ifdef __x86_64__\n#include <immintrin.h>\n#endif\n' >>"$work/standard.c"
"$CC" -std=c99 -dM -E "$work/standard.c" 2>/dev/null | awk '{ sub(/\(.*/, "", $2); print $2 }' | sort -u >"$work/standard"
macros() {
    "$CC" -std=c99 -I. -dM -E "$2" 2>/dev/null | awk '{ sub(/\(.*/, "", $2); print $2 }' | sort -u >"$work/$1.defined"
    { [ -s "$work/$1.defined" ] || echo "no macro at all"
      comm -13 "$work/standard" "$work/$1.defined" | grep -vE "^($3)" | sed 's/$/ is left defined/'; } >"$work/$1.leaked"
    verdict "$1" "$work/$1.leaked"
}
echo '#include "yarncloth.h"' >"$work/header.c"
macros symbols-macros-header "$work/header.c" 'YC_|YARNCLOTH'
macros symbols-macros-implementation "$work/unit.c" 'YC_|YCI_|YARNCLOTH'
