# The tests under sanitizers of addresses and undefined behaviour.
. tests/check/common.sh

echo 'int main(void) { return 0; }' >"$work/probe.c"
if ! "$CC" -fsanitize=address,undefined "$work/probe.c" -o "$work/probe" 2>/dev/null || ! "$work/probe"; then
    if [ "${CHECK_STRICT:-0}" = 1 ]; then failed sanitize "no sanitizers here"; else echo "skip sanitize: no sanitizers here"; fi
    exit 0
fi
attempt sanitize make -s sanitize
