# What the tests of the command share. $MOTEHOUND is the program.
: "${MOTEHOUND:?the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

complain() {
    echo "FAIL: $*" >&2
    failures=$((failures + 1))
}

# refused PATTERN COMMAND...: status 1, nothing on standard output, one line on standard error that matches.
refused() {
    local pattern=$1 status
    shift
    "$@" >out.txt 2>err.txt
    status=$?
    [ $status -eq 1 ] || complain "status $status, expected 1: $*"
    [ ! -s out.txt ] || complain "standard output of: $*"
    [ "$(wc -l <err.txt)" -eq 1 ] || complain "expected one line, found: $(cat err.txt): $*"
    grep -Eq -- "$pattern" err.txt || complain "expected '$pattern', found '$(cat err.txt)': $*"
}

# accepted COMMAND...: status 0 and nothing on standard error.
accepted() {
    "$@" >out.txt 2>err.txt || complain "status $?: $*: $(cat err.txt)"
    [ ! -s err.txt ] || complain "standard error of $*: $(cat err.txt)"
}

# nothing FOLDER: neither it nor anything half-written beside it.
nothing() {
    [ ! -e "$1" ] || complain "$1 exists"
    [ -z "$(find . -name '.*partial*')" ] || complain "half-written files beside $1"
}

conclude() {
    [ $failures -eq 0 ] || exit 1
    echo passed
}
