# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The Debian packages that Morsel is built from, and their installation. Sourced, after steps.sh.

# Debian 12 and 13 use the same names; the same name brings Embree 3.13 on the one and 4.3 on the
# other. openimageio-tools is here because find_package(OpenImageIO) fails without the programs that
# its CMake package lists, and the -dev package does not depend on them.
MORSEL_PACKAGES=(
  cmake ninja-build g++ pkg-config
  libembree-dev libtbb-dev libhwy-dev
  libopenimageio-dev openimageio-tools libopenexr-dev libimath-dev
  libassimp-dev libtinygltf-dev nlohmann-json3-dev
  libcli11-dev libspdlog-dev libfmt-dev libxxhash-dev
  libboost-dev libeigen3-dev libnanoflann-dev
  libgtest-dev
)

# What some tests look at Morsel's files with; they are skipped where it is missing.
MORSEL_TEST_PACKAGES=(python3-jsonschema zsh fish)
# What the tests labelled `slow` use besides: CGAL judges whether meshes intersect themselves.
MORSEL_SLOW_TEST_PACKAGES=(libcgal-dev)

# Prints those of the given packages that are not installed, one a line.
missing_packages() {
  local package
  for package in "$@"; do
    if [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) != installed ]]; then
      echo "$package"
    fi
  done
}

# Sets `as_root` to the words that run a command as root; fails when there is no way to.
find_root() {
  if [[ $EUID -eq 0 ]]; then
    as_root=(env)
  elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || { [[ -t 0 ]] && sudo -v; }; }; then
    as_root=(sudo env)
  else
    return 1
  fi
}

# Installs what is missing of MORSEL_PACKAGES; touches neither network nor apt when nothing is.
# Exits 2 with the command to run when that needs rights that this user does not have.
install_packages() {
  begin_step "Packages"
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    cat >&2 <<TEXT
This system has no apt-get. Install what these Debian packages hold, then add --no-packages:
  ${MORSEL_PACKAGES[*]}
TEXT
    exit 2
  fi
  local missing
  mapfile -t missing < <(missing_packages "${MORSEL_PACKAGES[@]}")
  if [[ ${#missing[@]} -eq 0 ]]; then
    end_step "all ${#MORSEL_PACKAGES[@]} are installed"
    return
  fi
  local as_root
  if ! find_root; then
    cat >&2 <<TEXT
Packages are missing, and installing them needs root. Run this as root, then this script again:
  apt-get update && apt-get install -y --no-install-recommends ${missing[*]}
TEXT
    exit 2
  fi
  echo "Installing ${missing[*]}"
  local apt=("${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300)
  # One unreachable source among several need not matter: the installation decides.
  run_logged build/logs/apt-update.log "${apt[@]}" update ||
    echo "apt-get update failed; trying to install from the package lists at hand" >&2
  run_logged build/logs/apt-install.log \
    "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
  end_step "${#missing[@]} installed with what they depend on"
}
