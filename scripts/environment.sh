# Sourced by scripts/coilset: find_environment sets `python` and `enter`, making the environment where there is none.
# shellcheck shell=bash

private_root=$COILSET_CACHE/debian-13
record=/etc/coilset-packages # in the private root: what was installed there
modules="dolfinx petsc4py mpi4py gmsh meshio pyvista numba scipy pydantic typer rich xarray h5netcdf h5py yaml matplotlib pytest"

say() { printf 'coilset: %s\n' "$*" >&2; }
fail() { say "$*"; exit 2; }

packages() { tr '\n' ' ' < "$scripts/packages.txt"; }

complete() { # has this Python every module, and DOLFINx >= 0.9?
    PYTHONPATH='' "$1" - $modules 2> /dev/null << 'PYTHON'
import importlib.metadata, importlib.util, sys
missing = [name for name in sys.argv[1:] if importlib.util.find_spec(name) is None]
version = importlib.metadata.version("fenics-dolfinx").split(".")
sys.exit(bool(missing) or (int(version[0]), int(version[1])) < (0, 9))
PYTHON
}

find_python() {
    local candidate
    for candidate in "${COILSET_PYTHON:-}" "$(command -v python3 || true)" /usr/bin/python3; do
        [ -n "$candidate" ] && complete "$candidate" && python=$candidate && return 0
    done
    return 1
}

distribution() { # prints "debian 12" or "ubuntu 2504"
    # shellcheck disable=SC1091
    (. /etc/os-release 2> /dev/null && printf '%s %s\n' "${ID:-none}" "$(tr -d . <<< "${VERSION_ID:-999}")") || echo 'none 0'
}

find_environment() {
    find_python && enter_directly && return
    private_root_complete && enter_private_root && return

    local id version
    read -r id version <<< "$(distribution)"
    case "$id" in
        debian | ubuntu) ;;
        *) fail "no Python with DOLFINx >= 0.9 found; make one with 'conda env create -f environment.yml' and run this again" ;;
    esac
    [ "$(id -u)" = 0 ] || fail "no Python with DOLFINx >= 0.9 found, and installing needs root; run this once as root, \
or make one with 'conda env create -f environment.yml'"
    if { [ "$id" = debian ] && [ "$version" -ge 13 ]; } || { [ "$id" = ubuntu ] && [ "$version" -ge 2504 ]; }; then
        install_here
        find_python || fail "the packages are installed, but Python does not find them"
        enter_directly
    else
        make_private_root
        enter_private_root
    fi
}

enter_directly() {
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    enter() { exec "$@"; }
}

quietly() { # run with the output in a log file, a dot every five seconds, and the log's end if it fails
    local log=$COILSET_CACHE/environment.log
    "$@" > "$log" 2>&1 &
    local job=$! ticks=0
    trap 'kill "$job" 2> /dev/null' INT TERM
    while kill -0 "$job" 2> /dev/null; do
        sleep 1
        ticks=$((ticks + 1))
        [ $((ticks % 5)) -eq 0 ] && printf '.' >&2
    done
    trap - INT TERM
    [ "$ticks" -lt 5 ] || printf ' %s s\n' "$ticks" >&2
    wait "$job" || { tail -n 15 "$log" >&2; fail "that failed; the whole log is $log"; }
}

install_here() {
    mkdir -p "$COILSET_CACHE"
    say "installing DOLFINx, PETSc, gmsh and the rest from the distribution's packages (once, some minutes) ..."
    export DEBIAN_FRONTEND=noninteractive
    quietly apt-get update
    # shellcheck disable=SC2046
    quietly apt-get install -y --no-install-recommends $(packages)
}

private_root_complete() { # has the private root every package? It may have more: checkouts of all ages share it
    [ -f "$private_root$record" ] && ! grep -qvxFf "$private_root$record" "$scripts/packages.txt"
}

add_packages() { # to a private root that is there: seconds, where a new one takes minutes
    run_in_root() { bwrap --bind "$private_root" / --ro-bind /etc/resolv.conf /etc/resolv.conf --dev /dev --proc /proc \
        --setenv PATH /usr/sbin:/usr/bin:/sbin:/bin --setenv DEBIAN_FRONTEND noninteractive -- "$@"; }
    run_in_root dpkg --configure -a && run_in_root apt-get update &&
        run_in_root apt-get install -y --no-install-recommends $(packages) && run_in_root apt-get clean
}

make_private_root() {
    mkdir -p "$COILSET_CACHE"
    exec 9> "$COILSET_CACHE/environment.lock"
    flock -n 9 || { say "another coilset is making the environment; waiting for it ..."; flock 9; }
    private_root_complete && { exec 9>&-; return; }
    if ! command -v mmdebstrap > /dev/null || ! command -v bwrap > /dev/null; then
        say "installing mmdebstrap and bubblewrap ..."
        quietly apt-get update
        quietly apt-get install -y --no-install-recommends mmdebstrap bubblewrap
    fi
    if [ -d "$private_root" ]; then
        say "adding packages to the private Debian 13 (once, less than a minute) ..."
        (quietly add_packages) && finish_private_root && return
        say "making it anew instead"
    fi
    say "this system is older than DOLFINx's packages: making a private Debian 13 with them in"
    say "$private_root (once, 2 to 4 minutes, 3 GB; delete the folder to be rid of it) ..."
    local partial=$private_root.partial
    rm -rf "$partial"
    quietly mmdebstrap --variant=minbase --include="$(packages | tr ' ' ',')" trixie "$partial"
    rm -rf "$private_root"
    mv "$partial" "$private_root"
    finish_private_root
}

finish_private_root() {
    cp "$scripts/packages.txt" "$private_root$record"
    exec 9>&-
    say "the environment is ready"
}

enter_private_root() {
    python=/usr/bin/python3
    # The private root brings its own system folders; every other folder of this machine is seen through.
    enter() {
        local binds=() folder
        for folder in /*; do
            case "$folder" in
                /bin | /boot | /dev | /etc | /lib* | /proc | /run | /sbin | /sys | /usr | /var | /lost+found) ;;
                *) [ -d "$folder" ] && [ ! -L "$folder" ] && binds+=(--bind "$folder" "$folder") ;;
            esac
        done
        trap '' INT # bwrap must outlive Ctrl-C, which is for the command inside: that one listens to it again
        exec bwrap --bind "$private_root" / "${binds[@]}" --dev /dev --proc /proc --ro-bind /sys /sys \
            --setenv PATH /usr/local/bin:/usr/bin:/bin --setenv LANG C.UTF-8 --setenv HOME "$HOME" \
            --setenv OMPI_ALLOW_RUN_AS_ROOT 1 --setenv OMPI_ALLOW_RUN_AS_ROOT_CONFIRM 1 --setenv COILSET_PRIVATE_ROOT 1 \
            --chdir "$PWD" -- "$@"
    }
}

link_namespace() { # `import coilset.model` finds the folder model of this checkout, without an installation
    namespace=$COILSET_CACHE/checkouts/$(cksum <<< "$1" | cut -d ' ' -f 1)
    [ "$(readlink "$namespace/coilset" 2> /dev/null)" = "$1" ] || {
        mkdir -p "$namespace"
        ln -sfn "$1" "$namespace/coilset"
    }
}
