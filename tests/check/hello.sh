# The first program of README.md, the one in the head of yarncloth.h and examples/hello.c are the same text, at most 40
# lines, and it runs.
. tests/check/common.sh

awk '/^```/ && inside { exit } inside { print } /^```c *$/ { inside = 1 }' README.md >"$work/readme.c"
# From the first empty line after HELLO to THE IDEA, without ` * ` and four blanks, nor empty lines at either end.
awk '
    /^ \* THE IDEA/ { exit }
    inside {
        sub(/^ \*( (    )?)?/, "")
        if ($0 == "") { empty++; next }
        while (lines && empty-- > 0) print ""
        empty = 0
        lines++
        print
    }
    /^ \* HELLO/ { marker = 1 }
    marker && /^ \*$/ { inside = 1 }
' yarncloth.h >"$work/header.c"

for copy in readme header; do
    if cmp -s examples/hello.c "$work/$copy.c"; then ok "hello-$copy"; else
        failed "hello-$copy" "differs from examples/hello.c: $(diff examples/hello.c "$work/$copy.c" | sed -n '/^[<>]/{p;q;}')"
    fi
done
lines=$(wc -l <examples/hello.c | tr -d ' ')
if [ "$lines" -le 40 ]; then ok hello-short; else failed hello-short "$lines lines"; fi
attempt hello-runs make -s hello BUILD="$work/build"
