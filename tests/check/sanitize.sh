# The tests under sanitizers of addresses and undefined behaviour, but for the slowest, which take no path of their own;
# `make sanitize` runs those as well.
. tests/check/common.sh

echo 'int main(void) { return 0; }' >"$work/probe.c"
if ! "$CC" -fsanitize=address,undefined "$work/probe.c" -o "$work/probe" 2>/dev/null || ! "$work/probe"; then
    if [ "${CHECK_STRICT:-0}" = 1 ]; then failed sanitize "no sanitizers here"; else echo "skip sanitize: no sanitizers here"; fi
    exit 0
fi
slow='-woven_extremes -two_level_when_stiff -folded_layers -fabric_mechanics -knit_stockinette -knit_garter -knit_rib
    -knit_wide -knit_overstretched -knit_large -knit_extremes -knit_drapes -knit_wrapping_both -two_levels_are_direct
    -woven_figures_strip -all_give_the_same_step -dropped_edge_on -angular_momentum_first -energy_never_grows
    -swatch_hangs_alike'
attempt sanitize make -s -j "${JOBS:-2}" sanitize TESTS="$(echo --time $slow)" # in one line
