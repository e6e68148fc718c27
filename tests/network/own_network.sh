# A network of our own, for the tests that need multicast: own_network COMMAND... Skipped (77) where none may be made.
for program in unshare ip; do
    command -v $program >/dev/null || { echo "skipped: no $program"; exit 77; }
done
# Root may make a network namespace anywhere, others within a user namespace of their own.
own_network() { if unshare -n true 2>/dev/null; then unshare -n "$@"; else unshare -rn "$@"; fi; }
own_network sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo' 2>/dev/null || { echo "skipped: no network namespace may be made"; exit 77; }
