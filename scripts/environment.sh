# Sourced by scripts/coilset: find_environment sets `python` and `enter`, and `made` if it had to make the environment.
#
# An environment is, in this order: (a) a Python that has DOLFINx >= 0.9 and the other packages: $COILSET_PYTHON, or
# python3 of the PATH (conda, a venv), or /usr/bin/python3; (b) Debian >= 13 or Ubuntu >= 25.04 with root: the
# distribution's own packages; (c) an older Debian or Ubuntu with root: a private Debian in the user's cache folder.
# COILSET_RELEASE=sid asks for the private Debian of that release, whatever else there is.
# shellcheck shell=bash

modules="dolfinx petsc4py mpi4py gmsh meshio pyvista numba scipy pydantic typer rich xarray h5netcdf h5py yaml matplotlib jinja2 plotly pytest hypothesis"
ways="coilset needs DOLFINx >= 0.9, from conda or pip (no root needed) or as root from Debian; here is none. Ways to get one:
  conda, no root needed      conda env create -f environment.yml; conda activate coilset
  no conda, no root          install Miniforge into your home folder, then as above
  pip, no root needed        Linux on x86-64 with Python >= 3.12: wheels into a venv, see docs/install.md
  Debian 13, Ubuntu 25.04    or later, as root: run any command, it installs the distribution's packages
  older Debian and Ubuntu    as root: run any command, it makes a private Debian 13 in $COILSET_CACHE (3.5 GB)
COILSET_PYTHON names a Python that has it but is not the first on the PATH."

say() { printf 'coilset: %s\n' "$*" >&2; }
fail() { say "$*"; exit 2; }

# Without a trap, SIGINT ends this shell at once; but while it waits for a command, it forgets one that the command did not
# get. With a trap, it forgets what comes while it prepares exec or waits for a command substitution. So one is set only
# where commands are waited for; on the way from a record to Python there are neither.
hear_interrupts() { trap 'exit 130' INT; }

packages() { tr '\n' ' ' < "$scripts/packages.txt"; }
# Wheels of PyPI are installed as they were when they were chosen, by their digests: those for Python 3.13 and 3.14. They
# bring no dependencies: what they need is among the packages, which pip would replace.
wheels=(python3 -m pip install --break-system-packages --no-deps --only-binary :all: --require-hashes --requirement)
listed() { sed 's/==.*//' "$scripts/packages.txt" "$scripts/wheels.txt" | sort -u; } # names of both

# What was found is kept beside the checkout's link in the cache folder, one record for each python3 of the PATH: the
# kind, the Python, and facts: files and folders that must be there and not be newer than the record.
find_environment() {
    made=''
    local first=${COILSET_PYTHON:-} kind='' fact facts=()
    [ -n "$first" ] || first_of_path python3
    found=$namespace/found-${COILSET_RELEASE:-any}-${first//\//%}
    if recall; then
        "enter_$kind"
        return
    fi
    hear_interrupts
    if ! ready; then
        case " $* " in *' --help '* | *' -h '* | *' --version '* | '  ') printf '%s\n' "$ways" ${near:+"$near"}; exit 0 ;; esac
        [ -z "${COILSET_PYTHON:-}" ] || [ -n "${COILSET_RELEASE:-}" ] ||
            fail "COILSET_PYTHON: ${near:-$first is no Python with DOLFINx >= 0.9}"
        made=yes
        make_environment
    fi
    "enter_$kind"
    remember
}

first_of_path() { # sets `first`; as `type -P`, without a command substitution
    local folders folder
    IFS=: read -ra folders <<< "$PATH"
    for folder in "${folders[@]}"; do
        [ ! -x "$folder/$1" ] || [ -d "$folder/$1" ] || { first=$folder/$1; return; }
    done
}

recall() { # the record, if its facts still hold
    [ -f "$found" ] || return 1
    { read -r kind && read -r python && mapfile -t facts; } < "$found" || return 1
    for fact in "${facts[@]}"; do
        [ -e "$fact" ] && [ ! "$fact" -nt "$found" ] || return 1
    done
}

remember() {
    facts+=("$scripts/environment.sh" "$scripts/environment.py" "$scripts/packages.txt" "$scripts/wheels.txt")
    [ "$kind" = directly ] || facts+=("$private_root$record")
    printf '%s\n' "$kind" "$python" "${facts[@]}" > "$found.$$" && mv "$found.$$" "$found"
}

ready() { # is there an environment? Sets kind, python and the facts that this rests on, or what is near to one
    local candidate
    facts=() near=''
    if [ -z "${COILSET_RELEASE:-}" ]; then
        for candidate in "$first" /usr/bin/python3; do
            if [ -x "$candidate" ] && complete "$candidate"; then
                kind=directly python=$candidate
                return
            fi
            [ -z "${COILSET_PYTHON:-}" ] || return 1 # no other in place of what the user names
        done
    fi
    private_root_complete && kind=private_root python=/usr/bin/python3
}

complete() { # has this Python every module, and DOLFINx >= 0.9? Where it looks for them is added to the facts
    local line enough='' answer=$found.$$.answer
    # Over a file: bash does not reliably answer a signal in the midst of a substitution.
    PYTHONPATH='' PYTHONSAFEPATH=yes "$1" - $modules < "$scripts/environment.py" > "$answer" 2> /dev/null || true
    while read -r line; do
        case "$line" in
            enough) enough=yes ;;
            has\ *) near=${near:-$1 $line} ;;
            *) facts+=("$line") ;;
        esac
    done < "$answer"
    rm -f "$answer"
    [ -n "$enough" ]
}

distribution() { # prints "debian 12" or "ubuntu 2504"
    # shellcheck disable=SC1091
    (. /etc/os-release 2> /dev/null && printf '%s %s\n' "${ID:-none}" "$(tr -d . <<< "${VERSION_ID:-999}")") || echo 'none 0'
}

make_environment() {
    local id version
    read -r id version <<< "$(distribution)"
    if [ "$(id -u)" != 0 ] || { [ "$id" != debian ] && [ "$id" != ubuntu ]; }; then
        printf '%s\n' "$ways" ${near:+"$near"} >&2
        exit 2
    fi
    if [ -z "${COILSET_RELEASE:-}" ] && { { [ "$id" = debian ] && [ "$version" -ge 13 ]; } ||
        { [ "$id" = ubuntu ] && [ "$version" -ge 2504 ]; }; }; then
        install_here
    else
        make_private_root
    fi
    ready || fail "the packages are installed, but Python does not find them"
}

install_here() {
    mkdir -p "$COILSET_CACHE"
    log=$COILSET_CACHE/packages.log
    say "installing DOLFINx, PETSc, gmsh and the rest from the distribution's packages (once, some minutes) ..."
    export DEBIAN_FRONTEND=noninteractive
    quietly apt-get update
    # shellcheck disable=SC2046
    quietly apt-get install -y --no-install-recommends $(packages)
    (quietly "${wheels[@]}" "$scripts/wheels.txt") || say "PyPI was not reached: sweeps write no Parquet file"
}

progress() { # of an installation, in per cent by its log: each package is unpacked and set up; nothing before that
    local total steps
    total=$(grep -oE '[0-9]+ newly installed' "$log" | awk '{ sum += $1 } END { print sum + 0 }')
    steps=$(grep -cE '^(Unpacking|Setting up) ' "$log" || true)
    [ "$total" -eq 0 ] || printf '%s %%' "$((steps < 2 * total ? 50 * steps / total : 100))"
}

quietly() { # run with the output in the file $log, the progress every five seconds, and the log's end if it fails
    "$@" > "$log" 2>&1 &
    local job=$! ticks=0
    trap 'kill "$job" 2> /dev/null' INT TERM
    while kill -0 "$job" 2> /dev/null; do
        sleep 1
        ticks=$((ticks + 1))
        [ $((ticks % 5)) -ne 0 ] || if [ -t 2 ]; then
            printf '\rcoilset: %s s %s ' "$ticks" "$(progress)" >&2
        else
            [ $((ticks % 20)) -eq 0 ] && printf ' %s' "$(progress)" >&2 || printf '.' >&2
        fi
    done
    hear_interrupts
    trap - TERM
    [ "$ticks" -lt 5 ] || printf ' %s s\n' "$ticks" >&2
    wait "$job" || { tail -n 15 "$log" >&2; fail "that failed; the whole log is $log"; }
}

enter_directly() {
    enter() {
        local hold=()
        case "$OSTYPE" in linux-gnu*) hold=(env --block-signal=INT) ;; esac # held back until Python can answer Ctrl-C
        exec ${hold[@]+"${hold[@]}"} "$@"
    }
}

# Python looks for modules in the checkout and in what the user names, and not in the working directory, which an empty
# name would mean.
modules_of_coilset() {
    local name names=()
    IFS=: read -ra names <<< "${PYTHONPATH:-}"
    PYTHONPATH=$namespace
    for name in ${names[@]+"${names[@]}"}; do PYTHONPATH+=${name:+:$name}; done
    export PYTHONPATH PYTHONSAFEPATH=${PYTHONSAFEPATH:-coilset}
}

link_namespace() { # `import coilset.model` finds the folder model of this checkout, without an installation
    namespace=$COILSET_CACHE/checkouts/${1//\//%}
    [ "$namespace/coilset" -ef "$1" ] || {
        hear_interrupts
        mkdir -p "$namespace"
        ln -sfn "$1" "$namespace/coilset"
    }
}
