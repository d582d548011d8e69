#!/usr/bin/env bash
# Installs what the pipeline needs: system packages (FreeFEM, a fast BLAS, a C compiler, the libraries gmsh links to) and
# .venv with the Python packages of requirements.lock. Installs only what is missing; run it as often as you like.
# PYTHON=/path/to/python3 ./setup.sh chooses the interpreter.
#   --browser    chromium as well, in which tests open the pages
#   --slurm      Snakemake's executor for Slurm as well, which profiles/slurm needs
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

BROWSER= SLURM=
for option in "$@"; do
    case $option in
        --browser) BROWSER=1 ;;
        --slurm) SLURM=1 ;;
        *) printf 'setup.sh: %s: no such option; there are --browser and --slurm\n' "$option" >&2; exit 1 ;;
    esac
done

readonly LOCK=requirements.lock SLURM_LOCK=requirements-slurm.lock
readonly STAMP=.venv/complete # written last: .venv is as the lock says

# Shared libraries that gmsh's wheel loads but does not bring, and the packages that have them.
readonly GMSH_LIBRARIES="
    libGL.so.1:libgl1 libGLU.so.1:libglu1-mesa libX11.so.6:libx11-6 libXcursor.so.1:libxcursor1 libXext.so.6:libxext6
    libXfixes.so.3:libxfixes3 libXft.so.2:libxft2 libXinerama.so.1:libxinerama1 libXrender.so.1:libxrender1
    libfontconfig.so.1:libfontconfig1 libgomp.so.1:libgomp1"
# FreeFEM runs one thread per process, so the BLAS without threads is as fast as the others.
readonly BLAS=libopenblas0-serial

say() { printf '%s\n' "$*"; }
die() { printf 'setup.sh: %s\n' "$*" >&2; exit 1; }

# Is the Debian package $1 installed? False on systems without dpkg.
has_package() { [[ $(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]; }

# Where the dynamic linker finds the library $1, empty if nowhere.
library() { awk -v name="$1" '$1 == name { print $NF; exit }' <<<"$LIBRARIES"; }

# An interpreter that can make .venv: 3.11 or newer, with venv and pip's installer.
find_python() {
    local candidate
    for candidate in ${PYTHON:-python3 /usr/bin/python3 python3.13 python3.12 python3.11}; do
        if "$candidate" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            printf '%s' "$candidate"
            return
        fi
    done
}

# The packages to install, one a line.
missing_packages() {
    local freefem pair
    freefem=$(command -v FreeFem++ || true)
    if [[ -z $freefem ]]; then
        printf '%s\n' freefem++ libfreefem++
    elif has_package freefem++ && ! has_package libfreefem++; then
        printf '%s\n' libfreefem++ # the plugins
    fi
    # Only Debian's FreeFEM takes the system's BLAS; */blas/* is the reference one, four times slower.
    if [[ -z $freefem ]] || has_package freefem++; then
        case $(readlink -f "$(library libblas.so.3)") in
            "" | */blas/*) has_package $BLAS || printf '%s\n' $BLAS ;;
        esac
    fi
    for pair in $GMSH_LIBRARIES; do
        [[ -n $(library "${pair%%:*}") ]] || printf '%s\n' "${pair##*:}"
    done
    [[ -z $BROWSER ]] || command -v chromium >/dev/null || printf '%s\n' chromium
    if [[ -z ${PYTHON:-} ]] && ! is_complete && [[ -z $(find_python) ]]; then
        printf '%s\n' python3-venv
    fi
}

# Runs a command whose output is of interest only when it fails.
quietly() {
    local log status=0
    log=$(mktemp)
    "$@" </dev/null >"$log" 2>&1 || status=$?
    [[ $status == 0 ]] || tail -n 20 "$log" >&2
    rm "$log"
    return $status
}

install_packages() {
    local as_root=()
    if [[ $(id -u) != 0 ]]; then
        as_root=(sudo -n)
        [[ -t 0 ]] && as_root=(sudo) # somebody is there to type a password
    fi
    if ! command -v apt-get >/dev/null || ! "${as_root[@]}" true 2>/dev/null; then
        die "these system packages are missing and cannot be installed from here: $*
As root, on Debian or Ubuntu:
    apt-get update && apt-get install --no-install-recommends $*
then run ./setup.sh again. A FreeFem++ of your own need only be on PATH."
    fi
    say "Installing system packages: $*"
    local apt_get=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=120)
    quietly "${apt_get[@]}" update || say "apt-get update failed: trying with the package lists at hand"
    quietly "${apt_get[@]}" install --yes --no-install-recommends "$@" || die "apt-get could not install: $*"
}

version() { "$1" -V 2>/dev/null || true; }

# What .venv must agree with: the lock, this folder (programs in .venv name it) and the version of Python.
wanted_stamp() { printf '%s %s %s' "$(sha256sum <"$LOCK")" "$PWD" "$(version "${PYTHON:-.venv/bin/python}")"; }
is_complete() { [[ -x .venv/bin/python && -e $STAMP && $(<"$STAMP") == "$(wanted_stamp)" ]]; }

install_python_packages() {
    local python clear=()
    python=$(find_python)
    [[ -n $python ]] || die "Python 3.11 or newer with its venv module is needed; ${PYTHON:-python3} is \
$("${PYTHON:-python3}" -V 2>&1 || true). Install one and name it:
    PYTHON=/path/to/python3.11 ./setup.sh"
    # gmsh publishes a wheel for this one only
    [[ $(uname -m) == x86_64 ]] || die "gmsh has no Python package for Linux on $(uname -m); x86_64 is needed."
    say "Installing Python packages into .venv (a minute or two, once)"
    # a .venv of another Python or of another folder is built anew
    if [[ $(version "$python") != "$(version .venv/bin/python)" || ! -e $STAMP || $(<"$STAMP") != *" $PWD "* ]]; then
        clear=(--clear)
    fi
    [[ ! -L .venv ]] || rm .venv # a link to another's, which is not to be cleared
    "$python" -m venv "${clear[@]}" .venv || die "$python could not make .venv"
    rm -f "$STAMP"
    # --use-pep517 for connection-pool, which is published as source alone: old and new pip build it the same way
    quietly .venv/bin/python -m pip install --disable-pip-version-check --no-input --require-hashes --use-pep517 \
        --requirement "$LOCK" || die "pip could not install the packages of $LOCK"
    .venv/bin/python -c 'import gmsh, snakemake' || die "the Python packages are installed but do not load"
    wanted_stamp >"$STAMP"
}

# Snakemake's executor for Slurm; what it needs has the other lock.
install_slurm_plugin() {
    quietly .venv/bin/python -m pip install --disable-pip-version-check --no-input --require-hashes --no-deps \
        --requirement "$SLURM_LOCK" || die "pip could not install the packages of $SLURM_LOCK"
}

# The command of this checkout, from whatever folder it is called; -P keeps that folder's modules out.
write_command() {
    cat >.venv/bin/muscle <<'END'
#!/bin/sh
bin=$(dirname -- "$(readlink -f -- "$0")")
PYTHONPATH=$bin/../.. exec "$bin/python" -P -m workflow "$@"
END
    chmod +x .venv/bin/muscle
}

# A clock for FreeFEM that is no call of the kernel (solver/clock.c): wanted, not needed.
compile_clock() {
    local cc library=.venv/lib/muscle_clock.so
    cc=$(command -v cc || command -v gcc) || return 0
    [[ $library -nt solver/clock.c ]] || quietly "$cc" -O2 -shared -fPIC -o "$library" solver/clock.c ||
        say "solver/clock.c could not be compiled: FreeFEM will take up to a third longer."
}

# Our sources compiled, as pip does it with those of packages: where PYTHONDONTWRITEBYTECODE is set or the checkout is
# read-only every program of a run would compile them again.
compile_sources() { quietly .venv/bin/python -m compileall -q geometry solver workflow || true; }

LIBRARIES=$(PATH=$PATH:/usr/sbin:/sbin ldconfig -p)
mapfile -t missing < <(missing_packages)
# Wanted, not needed: maps are compiled for simulators (workflow/answers/maps/fmu.py), and a clock.
if ! command -v cc >/dev/null && ! command -v gcc >/dev/null; then
    if command -v apt-get >/dev/null && { [[ $(id -u) == 0 ]] || sudo -n true 2>/dev/null; }; then
        missing+=(gcc libc6-dev)
    else
        say "There is no C compiler (gcc): FMUs of maps will hold their source alone, FreeFEM takes up to a third longer."
    fi
fi
[[ ${#missing[@]} == 0 ]] || install_packages "${missing[@]}"
is_complete || install_python_packages
[[ -x .venv/bin/muscle ]] || write_command
[[ -z $SLURM ]] || install_slurm_plugin
compile_clock
compile_sources
say "Everything is installed. Next:
    .venv/bin/snakemake --cores 2 --config study=config/smoke/study.yaml    a small study, for a first look
    .venv/bin/snakemake --cores 2                                           the whole study
    .venv/bin/pytest                                                        the tests"
