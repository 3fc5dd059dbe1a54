# clang-format would change nothing (`make format` does), no line passes 120 columns except the rules of banners, no
# blanks at ends of lines, no tabs.
. tests/check/common.sh

sources | xargs awk 'length($0) > 120 && !/[-=][-=][-=] \*\/$/ { print FILENAME ":" FNR ": " length($0) " columns" }' >"$work/wide"
verdict format-columns "$work/wide"
sources | xargs grep -nE "$(printf '\t')|[ ]+\$" >"$work/blanks"
verdict format-blanks "$work/blanks"

need clang-format format
sources | xargs clang-format --dry-run -Werror >"$work/log" 2>&1
status=$?
grep 'error:' "$work/log" >"$work/complaints"
[ $status = 0 ] || [ -s "$work/complaints" ] || cp "$work/log" "$work/complaints"
verdict format "$work/complaints"
