# Sourced by scripts/coilset: a private Debian in the user's cache folder, made by mmdebstrap, entered by bubblewrap.
# shellcheck shell=bash

case "${COILSET_RELEASE:-trixie}" in
    trixie) private_root=$COILSET_CACHE/debian-13 ;;
    *) private_root=$COILSET_CACHE/debian-$COILSET_RELEASE ;;
esac
record=/etc/coilset-packages # in the private root: what was installed there
# Signed lists are valid for a week, lest a mirror gives old ones, with packages whose faults are known. Mirrors of
# releases in the making are often older, but not by more than a month.
least_validity=0
[ "${COILSET_RELEASE:-trixie}" = trixie ] || least_validity=$((30 * 24 * 3600)) # s

private_root_complete() { # has the private root every package? It may have more: checkouts of all ages share it
    [ -f "$private_root$record" ] && ! listed | grep -qvxFf "$private_root$record"
}

make_private_root() {
    mkdir -p "$COILSET_CACHE"
    log=$private_root.log
    exec 9> "$private_root.lock"
    if ! flock -n 9; then
        say "another coilset is making the environment; waiting for it ..."
        flock 9
        ! private_root_complete || made='' # the other one compiles
    fi
    private_root_complete || install_tools
    private_root_complete || { [ -d "$private_root" ] && add_packages; } || make_it_anew
    exec 9>&-
}

install_tools() {
    if ! command -v mmdebstrap > /dev/null || ! command -v bwrap > /dev/null; then
        say "installing mmdebstrap and bubblewrap ..."
        quietly apt-get update
        quietly apt-get install -y --no-install-recommends mmdebstrap bubblewrap
    fi
}

make_it_anew() {
    local release=${COILSET_RELEASE:-trixie} partial=$private_root.partial
    say "making a private Debian ($release) with DOLFINx and the rest in"
    say "$private_root (once, some minutes, 3.5 GB; delete the folder to be rid of it) ..."
    discard "$partial"
    quietly mmdebstrap --verbose --variant=minbase \
        --aptopt="Acquire::Min-ValidTime \"$least_validity\"" --include="$(packages | tr ' ' ',')" "$release" "$partial"
    add_wheels "$partial"
    listed > "$partial$record"
    rm -rf "$private_root"
    mv "$partial" "$private_root"
    say "the environment is ready"
}

discard() { # a folder in which one that was killed may have left file systems of this machine mounted
    local place
    while read -r _ place _; do
        printf -v place '%b' "$place" # a space is \040 there
        [[ $place != "$1"/* ]] || umount "$place"
    done < <(tac /proc/mounts)
    rm -rf --one-file-system "$1"
}

add_packages() { # to a private root that is there: a minute at most, where a new one takes several
    say "adding packages to $private_root (once, less than a minute) ..."
    (quietly add_all) || { say "making it anew instead"; return 1; }
    add_wheels "$private_root"
    listed | sort -u - "$private_root$record" -o "$private_root$record"
}

add_all() {
    local update=(apt-get update -o Acquire::Check-Valid-Until=true -o "Acquire::Min-ValidTime=$least_validity")
    # shellcheck disable=SC2046
    in_root "$private_root" dpkg --configure -a && in_root "$private_root" "${update[@]}" &&
        in_root "$private_root" apt-get install -y --no-install-recommends $(packages) && in_root "$private_root" apt-get clean
}

in_root() { # as root in a folder; certificates are this machine's
    bwrap --bind "$1" / --ro-bind /etc/resolv.conf /etc/resolv.conf --ro-bind-try /etc/ssl /etc/ssl --dev /dev --proc /proc \
        --ro-bind "$scripts" /mnt --setenv PATH /usr/sbin:/usr/bin:/sbin:/bin --setenv HOME /root \
        --setenv DEBIAN_FRONTEND noninteractive -- "${@:2}"
}

add_wheels() { # what Debian does not have, from PyPI; coilset runs without it, and says what is missing when it is needed
    (quietly in_root "$1" "${wheels[@]}" /mnt/wheels.txt) || say "PyPI was not reached: sweeps write no Parquet file"
}

# The private root brings its own system folders; every other folder of this machine is seen through, and nothing can be
# written into its own. This shell stays above bubblewrap, which ends with it however it ends (SIGKILL too) and takes the
# command along. Signals are for the command: bubblewrap ignores or blocks them, and this shell passes them on, from
# before there is a command.
enter_private_root() {
    enter() {
        local binds=() pipe ended child='' early=() signal reset=TERM
        folders_seen
        refuse_unseen "$@"
        signal_in SigIgn $$ INT || reset+=,INT # ignored from above, as in a script's background: stays so
        exec {pipe}<> <(:) {ended}< "/dev/fd/$pipe" # which the command holds open for as long as it lives
        trap 'pass_on INT' INT
        trap 'pass_on TERM' TERM
        # In a shell's background, SIGINT is ignored and the input is empty: both are given back.
        (
            trap '' TERM
            exec env --block-signal=INT bwrap --die-with-parent --bind "$private_root" / --dev /dev --proc /proc \
                --ro-bind /sys /sys "${binds[@]}" --remount-ro / --setenv PATH /usr/local/bin:/usr/bin:/bin \
                --setenv LANG C.UTF-8 --setenv HOME "$HOME" --setenv COILSET_PRIVATE_ROOT 1 \
                --unsetenv PYTHONHOME --setenv PYTHONPATH "$namespace" --setenv PYTHONNOUSERSITE 1 \
                --unsetenv LD_LIBRARY_PATH --unsetenv LD_PRELOAD --chdir "$PWD" \
                -- env --default-signal=$reset --block-signal=INT "$@"
        ) <&0 &
        child=$!
        exec {pipe}>&-
        for signal in ${early[@]+"${early[@]}"}; do pass_on "$signal"; done
        # A signal just before `wait` would be answered when that ends; `read` answers within a second.
        while kill -0 "$child" 2> /dev/null; do
            read -rt 1 -u "$ended" || (($? > 128)) || wait "$child" || true
        done
        wait "$child" || exit
    }
}

folders_seen() { # appends to `binds`
    local folder
    for folder in /* /usr/local/* /dev/shm; do
        [ ! -d "$folder" ] || [ -L "$private_root$folder" ] || hidden "$folder" || binds+=(--bind "$folder" "$folder")
    done
}

hidden() { # has the private root a folder of its own in place of this machine's?
    case "$1/" in
        /dev/shm/ | /dev/shm/* | /dev/std* | /dev/fd/* | /dev/null/) return 1 ;;
        /usr/local/bin/* | /usr/local/etc/* | /usr/local/include/* | /usr/local/lib* | /usr/local/sbin/*) ;;
        /usr/local/?*/*) return 1 ;;
        /bin/* | /boot/* | /dev/* | /etc/* | /lib* | /lost+found/* | /proc/ | /sbin/* | /sys/* | /usr/*) ;;
        *) return 1 ;;
    esac
}

refuse_unseen() { # words of a command that name what is hidden, the working directory, and the checkout
    local word place
    cd -P . 2> /dev/null || fail "the working directory is no longer there"
    for word in "$PWD" "$repository" "$@"; do
        place=${word##*=} # of --out=FOLDER, or of an entry of a case
        ! hidden "$place" || { [ "$place" != "$PWD" ] && [ -e "$private_root$place" ]; } ||
            fail "$place: cannot be seen from the private Debian, which has such folders of its own; take another place"
    done
}

# A signal to the command in bubblewrap, as soon as there is one. An interrupt waits there, being blocked, until Python can
# answer; SIGTERM is ignored there at first. Where the terminal sends Ctrl-C, a command that blocks it no longer has it.
pass_on() {
    local command=''
    [ -n "$child" ] || { early+=("$1"); return; }
    until { read -r command < "/proc/$child/task/$child/children" || [ -n "$command" ]; } 2> /dev/null &&
        { [ "$1" = INT ] || ! signal_in SigIgn "$command" "$1"; }; do
        read -rt "0${EPOCHREALTIME//[0-9]/}01" -u "$ended" || (($? > 128)) || return 0 # it has ended
    done
    if [ "$1" != INT ] || ! in_foreground || signal_in SigBlk "$command" INT; then
        kill -s "$1" "$command" 2> /dev/null || true
    fi
}

signal_in() { # is it in that set (SigIgn, SigBlk) of the process?
    local name mask number=2
    [ "$3" = INT ] || number=15 # SIGTERM
    { while read -r name mask; do [ "$name" != "$1:" ] || break; done < "/proc/$2/status"; } 2> /dev/null || return
    (((16#${mask:-0} >> (number - 1)) & 1))
}

in_foreground() { # are we where the terminal sends Ctrl-C? Then it reaches the command by itself
    local fields
    read -r fields < "/proc/$$/stat"
    read -ra fields <<< "${fields##*) }"
    [ "${fields[2]}" = "${fields[5]}" ]
}
