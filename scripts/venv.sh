# Makes virtual environments; to be sourced by the other scripts.
# Usage: make_venv FOLDER
#        install_into FOLDER REQUIREMENT ...    with the options that pip and uv share
# Needs Python 3.11 or later (named by $PYTHON, python3 if it is not set).

make_venv() {
    local python="${PYTHON:-python3}" folder="$1"
    [ -x "$folder/bin/python" ] && return
    "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
        echo "Python 3.11 or later is needed; set PYTHON to one" >&2
        return 1
    }
    "$python" -m venv "$folder" 2>/dev/null && return
    # Debian's Python comes without venv.
    rm -rf "$folder"
    if command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
        { apt-get update && apt-get install --yes python3-venv; } >/dev/null 2>&1 &&
            "$python" -m venv "$folder" && return
        rm -rf "$folder"
    fi
    local tools
    tools="$(mktemp -d)"
    "$python" -m pip install --quiet --target "$tools" virtualenv &&
        PYTHONPATH="$tools" "$python" -m virtualenv --quiet "$folder"
    local status=$?
    rm -rf "$tools"
    return $status
}

# uv keeps what it has unpacked for the next environment; pip does it where uv cannot be had or fails, and says why.
# Modules are compiled when they are imported first: most of those that are installed never are.
install_into() {
    local folder="$1"
    shift
    local pip=("$folder/bin/python" -m pip install --quiet --disable-pip-version-check --no-compile)
    [ -x "$folder/bin/uv" ] || "${pip[@]}" uv || true
    "$folder/bin/uv" pip install --quiet --python "$folder/bin/python" "$@" 2>/dev/null ||
        { "${pip[@]}" --upgrade "pip>=25.1" && "${pip[@]}" "$@"; }
}
