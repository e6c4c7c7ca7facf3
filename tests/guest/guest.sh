#!/usr/bin/env bash
# Boots the distribution's PREEMPT_RT kernel in QEMU (software emulation: no KVM needed) and runs
# one command inside it. See docs/guest.md.
#
#   guest.sh setup                  install the packages, and the newest real-time kernel's headers
#   guest.sh build                  make kernel, modules and root image, unless they are up to date
#   guest.sh build --debian         and a second root image: a bare Debian in which apt works
#   guest.sh run [options] -- CMD.. boot, run CMD in the guest's /tmp, end with CMD's status
#     --share DIR   folder of the host, read-only in the guest as /mnt/share
#     --out DIR     folder of the host, writable in the guest as /mnt/out; also gets log, status,
#                   console.log, dmesg.log, journal.log (default: a temporary one, log to stdout)
#     --systemd     systemd is process 1 (default: a shell script)
#     --debian      the second root image; packages come from /mnt/share/packages, a flat repository
#     --det         one processor on virtual time, 2 ns an instruction: a slow host does not show
#     --timeout S   the host's limit (default 120)
#
# Exit: CMD's status; 2 bad usage; 124 out of time; 125 the guest ended without a status (a panic).
# What build makes is kept in $XDG_CACHE_HOME/flexarm-guest, or in build/guest.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
cache=${XDG_CACHE_HOME:+$XDG_CACHE_HOME/flexarm-guest}
cache=${cache:-$root/build/guest}

headers=linux-headers-rt-amd64  # depends on the headers of the current real-time kernel

# Contents of the root image: a small system, tools of the tests, and the libraries of flexarm's
# programs: those that the installed -dev packages belong to, whose names differ between releases.
guest_packages=(
  base-files base-passwd bash coreutils dash findutils grep iproute2 kmod libc-bin mawk mount passwd
  perl-base procps sed util-linux
  dbus systemd systemd-sysv
  can-utils gpiod jq libstdc++6 rt-tests sqlite3 stress-ng
)
dev_packages=(
  libcomedi-dev libfmt-dev libgpiod-dev libmodbus-dev libnlopt-dev libspdlog-dev libsqlite3-dev
  libsystemd-dev libtomlplusplus-dev libzstd-dev
)
# The bare Debian: what a small server has, so that the package's own dependencies are told apart.
debian_packages=(dbus iproute2 kmod procps systemd systemd-sysv)
# Modules in addition to gpio-sim, for the root image and for the initial RAM disk.
root_modules=(autofs4 can can-raw comedi comedi_parport comedi_test configfs vcan)
boot_modules=(9p 9pnet_virtio crc32c_generic ext4 virtio_blk virtio_pci virtio_rng)

fail() {
  echo "guest: $*" >&2
  exit 2
}

usage() {
  sed -n '/^#   /s/^#   //p' "${BASH_SOURCE[0]}" >&2
  exit 2
}

[[ $(uname -m) == x86_64 ]] || fail "the guest's kernel is for amd64, and this machine is not"

# Version of the kernel's packages, and release of the kernel: those of the installed headers.
package_version() { dpkg-query -W -f '${Version}' "$headers" 2>/dev/null; }
kernel_release() {
  dpkg-query -W -f '${Depends}' "$headers" 2>/dev/null | sed -n 's/^linux-headers-\([^ ,]*\).*/\1/p'
}

setup() {
  "$root/tools/install-deps" test
  local as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" apt-get -q -o DPkg::Lock::Timeout=300 update >&2
  "${as_root[@]}" apt-get -qy -o DPkg::Lock::Timeout=300 install --no-install-recommends \
    "$headers" >&2
}

runtime_libraries() {
  dpkg-query -W -f '${Depends}\n' "${dev_packages[@]}" | tr ',' '\n' |
    sed -n 's/^ *\(lib[^ ]*\) (=.*/\1/p' | grep -v -- '-dev$' | sort -u
}

# A hash of the inputs of build; a cache with the same stamp is up to date.
stamp() {
  package_version
  runtime_libraries
  kernel_release
  cat "$here/guest.sh" "$here/extract_kernel.py" "$here"/image/* | sha256sum
}

download() {  # download PACKAGE NEW_NAME
  (mkdir fetch && cd fetch && apt-get -q download "$1" && mv ./*.deb "../$2") >&2
  rmdir fetch
}

# Only the headers are installed on the host.
make_kernel() {
  download "linux-image-$release=$version" image.deb
  mkdir kernel
  dpkg-deb --fsys-tarfile image.deb | tar x -C kernel
  [[ -d kernel/lib ]] || ln -s usr/lib kernel/lib  # since Debian 13 the package has no /lib
  python3 "$here/extract_kernel.py" "kernel/boot/vmlinuz-$release" vmlinux
}

# Debian ships no gpio-sim: it is built from the source of the same version. Its interrupts come
# from irq_sim.c, which Debian's kernel has not either, so it is linked in; irq_to_desc is not
# exported, and generic_handle_irq does the same for these interrupts.
make_gpio_sim() {
  local source=linux-source-${release%%-*}  # 6.1.0-56-rt-amd64: linux-source-6.1
  source=${source%.*}
  download "$source=$version" source.deb
  mkdir gpio-sim
  # tar stops after the three files, which breaks the pipe, as expected.
  (set +o pipefail
   dpkg-deb --fsys-tarfile source.deb 2>/dev/null | tar xO "./usr/src/$source.tar.xz" 2>/dev/null |
     tar xJ -C gpio-sim --strip-components=3 --occurrence=1 \
       "$source"/drivers/gpio/{gpio-sim.c,gpiolib.h} "$source/kernel/irq/irq_sim.c")
  rm source.deb
  cd gpio-sim
  mv gpio-sim.c gpio-sim-main.c
  sed -i -e '/^EXPORT_SYMBOL_GPL/d' \
    -e 's/handle_simple_irq(irq_to_desc(irqnum))/generic_handle_irq(irqnum)/' irq_sim.c
  printf 'obj-m := gpio-sim.o\ngpio-sim-y := gpio-sim-main.o irq_sim.o\n' >Makefile
  make -s -C "/usr/src/linux-headers-$release" M="$PWD" modules >&2
  strip -g gpio-sim.ko
  cd ..
  install -Dm644 gpio-sim/gpio-sim.ko "kernel/lib/modules/$release/updates/gpio-sim.ko"
  /sbin/depmod -b kernel "$release"
}

# Files of the modules and of what they need, in the order of loading.
module_files() {
  local module
  for module; do
    /sbin/modprobe -d kernel -S "$release" --show-depends --ignore-install "$module"
  done | awk '$1 == "insmod" && !seen[$2]++ { print $2 }'
}

# Since Debian 13 modules are compressed, which the insmod of the initial RAM disk cannot read.
copy_module() {  # copy_module FILE TARGET
  mkdir -p "$(dirname "$2")"
  case $1 in
    *.xz) unxz -c "$1" >"${2%.xz}" ;;
    *) cp "$1" "$2" ;;
  esac
}

apt_sources() {
  local file
  for file in /etc/apt/sources.list.d/debian.sources /etc/apt/sources.list; do
    if [[ -s $file ]]; then echo "$file"; return; fi
  done
  fail "neither debian.sources nor sources.list in /etc/apt says where packages come from"
}

# Masks systemd's services that only cost time in a machine that runs for a minute.
mask_services() {
  local unit
  for unit in systemd-{udevd,udev-trigger,hwdb-update,timesyncd,firstboot,update-utmp}.service \
    systemd-{pstore,binfmt,random-seed,sysusers,remount-fs,modules-load,journal-flush}.service \
    systemd-udevd-{control,kernel}.socket modprobe@.service proc-sys-fs-binfmt_misc.automount \
    dev-{hugepages,mqueue}.mount sys-kernel-debug.mount sys-fs-fuse-connections.mount; do
    ln -sf /dev/null "$1/etc/systemd/system/$unit"
  done
}

# What the guest's command needs in both root images, but for the kernel's modules.
furnish() {  # furnish TREE
  echo flexarm-guest >"$1/etc/hostname"
  echo '127.0.0.1 localhost flexarm-guest' >"$1/etc/hosts"
  echo 0123456789abcdef0123456789abcdef >"$1/etc/machine-id"
  mkdir -p "$1"/mnt/{share,out}
  install -Dm755 "$here/image/guest_run.sh" "$1/usr/local/sbin/guest-run"
  install -m644 "$here"/image/guest.{service,target} "$1/etc/systemd/system/"
  mask_services "$1"
}

make_image() {  # make_image TREE FILE
  mke2fs -q -t ext4 -O ^has_journal,^metadata_csum -E lazy_itable_init=1 -m0 -d "$1" "$2" \
    "$(($(du -sm "$1" | cut -f1) * 5 / 4 + 512))M"  # free: what the log of a run needs
}

# Packages are unpacked without running their scripts, which takes a fifth of the time. The steps of
# the scripts that the guest needs follow.
make_root() {
  local tree=$PWD/tree file
  local packages
  packages=$(IFS=,; echo "${guest_packages[*]}"),$(runtime_libraries | paste -sd,)
  # shellcheck source=/dev/null
  mmdebstrap -q --variant=extract --mode=root --format=directory --include="$packages" \
    --hook-dir=/usr/share/mmdebstrap/hooks/merged-usr \
    "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$tree" "$(apt_sources)" >&2
  rm -rf "$tree"/usr/share/{doc,man,locale,info,lintian} "$tree"/var/{cache,lib}/apt
  for file in passwd group; do
    cp "$tree/usr/share/base-passwd/$file.master" "$tree/etc/$file"
  done
  : >"$tree/etc/shadow"
  : >"$tree/etc/fstab"
  printf 'passwd: files\ngroup: files\nhosts: files\n' >"$tree/etc/nsswitch.conf"
  furnish "$tree"
  chroot "$tree" /sbin/ldconfig
  chroot "$tree" systemd-sysusers
  ln -sf mawk "$tree/usr/bin/awk"
  module_files gpio-sim "${root_modules[@]}" "${boot_modules[@]}" |
    while read -r file; do
      copy_module "$file" "$tree/usr/lib/modules/${file#*/lib/modules/}"
    done
  cp "kernel/lib/modules/$release"/modules.{builtin,builtin.modinfo,order} \
    "$tree/usr/lib/modules/$release/"
  /sbin/depmod -b "$tree" "$release"
  make_image "$tree" root.ext4
}

# Installed by dpkg, so that apt goes on from there. What is installed is left beside the image.
make_debian_root() {
  local tree=$PWD/tree
  # shellcheck source=/dev/null
  mmdebstrap -q --variant=apt --mode=root --format=directory \
    --include="$(IFS=,; echo "${debian_packages[*]}")" \
    "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$tree" "$(apt_sources)" >&2
  rm -rf "$tree"/var/lib/apt/lists/* "$tree"/etc/apt/sources.list.d/*
  echo 'deb [trusted=yes] file:/mnt/share/packages ./' >"$tree/etc/apt/sources.list"
  furnish "$tree"
  debugfs -R "rdump /usr/lib/modules $tree/usr/lib" "$cache/root.ext4" 2>/dev/null
  compgen -G "$tree/usr/lib/modules/*/modules.dep" >/dev/null || fail "root.ext4 has no modules"
  make_image "$tree" debian.ext4
  cp "$tree/var/lib/dpkg/status" debian.dpkg-status
}

make_initrd() {
  local file
  mkdir -p initrd/{bin,dev,proc,sys,root,modules}
  cp /bin/busybox initrd/bin/
  module_files "${boot_modules[@]}" | while read -r file; do
    copy_module "$file" "initrd/modules/$(basename "$file")"
    basename "$file" .xz >>initrd/modules/order
  done
  install -m755 "$here/image/initrd_init.sh" initrd/init
  (cd initrd && find . | cpio --quiet -o -H newc) >initrd.cpio
}

timed() {
  local since=$SECONDS
  "$@"
  echo "guest: $1: $((SECONDS - since)) s" >&2
}

# As root, since the image's files belong to root, and alone.
begin_build() {
  rm -rf --one-file-system "$cache/work"
  mkdir "$cache/work"
  cd "$cache/work"
}

end_build() {  # end_build FILE..: keeps these
  mv "$@" "$cache"
  cd "$root"
  rm -rf --one-file-system "$cache/work"
}

build() {
  [[ -n $(kernel_release) ]] || fail "$headers is not installed: run tests/guest/guest.sh setup"
  mkdir -p "$cache"
  exec 8>"$cache/lock"
  flock 8
  local told
  told=$(stamp)
  if [[ $told == "$(cat "$cache/stamp" 2>/dev/null)" ]] &&
    [[ ${1:-} != --debian || $told == "$(cat "$cache/debian.stamp" 2>/dev/null)" ]]; then
    return
  fi
  if ((EUID != 0)); then
    exec sudo --preserve-env=XDG_CACHE_HOME "$here/guest.sh" build "$@"
  fi
  if [[ $told != "$(cat "$cache/stamp" 2>/dev/null)" ]]; then build_guest; fi
  if [[ ${1:-} == --debian ]]; then
    begin_build
    timed make_debian_root
    end_build debian.ext4 debian.dpkg-status
    stamp >"$cache/debian.stamp"
  fi
}

build_guest() {
  # An archive keeps no old kernels: if the current one is newer, its headers are installed first.
  if ! apt-cache show "linux-image-$(kernel_release)=$(package_version)" >/dev/null 2>&1; then
    setup
  fi
  release=$(kernel_release) version=$(package_version)
  echo "guest: building an image with $release ($version)" >&2
  begin_build
  timed make_kernel
  timed make_gpio_sim
  timed make_root
  timed make_initrd
  end_build vmlinux root.ext4 initrd.cpio
  stamp >"$cache/stamp"
}

# Sets `alone`, the command in front of QEMU: both of its threads on one core that no other guest has,
# as long as there is one, and the thread of the devices first, where the host permits that. On
# virtual time this thread takes an expired timer off its list and then interrupts the guest's
# processor. If the host stops it in between and the processor runs on, all timers of the guest are
# late by what is executed meanwhile.
keep_in_step() {
  local core
  for core in $(taskset -c -p $$ | sed 's/.*: //' | tr ',' '\n' |
    awk -F- '{ for (i = $1; i <= $NF; i++) print i }'); do
    exec {core_lock}>"$cache/core$core.lock"
    if flock -n "$core_lock"; then
      alone=(taskset -c "$core")
      break
    fi
    exec {core_lock}>&-
  done
  if chrt -R -f 1 true 2>/dev/null; then alone+=(chrt -R -f 1); fi
}

run() {
  local share='' out='' init=/usr/local/sbin/guest-run append='' limit_s=120 temporary='' qemu=0
  local image=root.ext4 needed=stamp
  local cpu=(-accel "tcg,thread=multi" -smp 2)
  local alone=()
  while (($#)); do
    case $1 in
      --share) share=$2; shift 2 ;;
      --out) out=$2; shift 2 ;;
      --systemd)
        init=/lib/systemd/systemd
        append="systemd.unit=guest.target systemd.show_status=0"
        shift
        ;;
      --debian) image=debian.ext4 needed=debian.stamp; shift ;;
      --det)
        cpu=(-accel "tcg,thread=single" -icount "shift=1,sleep=off" -smp 1)
        keep_in_step
        shift
        ;;
      --timeout) limit_s=$2; shift 2 ;;
      --) shift; break ;;
      *) usage ;;
    esac
  done
  (($#)) || usage
  [[ -s $cache/$needed ]] || fail "nothing to boot: run tests/guest/guest.sh build"
  if [[ -z $out ]]; then out=$(mktemp -d); temporary=$out; fi
  mkdir -p "$out"
  rm -f "$out/status"
  printf '%q ' "$@" >"$out/command"
  # snapshot=on: the guest's writes to its root are discarded.
  timeout -k 3 "$limit_s" "${alone[@]}" qemu-system-x86_64 -M q35 -cpu max "${cpu[@]}" \
    -m 1024 -nodefaults -display none -no-reboot -serial stdio \
    -kernel "$cache/vmlinux" -initrd "$cache/initrd.cpio" \
    -drive "file=$cache/$image,format=raw,if=virtio,snapshot=on" \
    -fsdev "local,id=s,path=${share:-$out},security_model=none,readonly=on" \
    -device virtio-9p-pci,fsdev=s,mount_tag=share \
    -fsdev "local,id=o,path=$out,security_model=none" -device virtio-9p-pci,fsdev=o,mount_tag=out \
    -device virtio-rng-pci -device isa-debug-exit,iobase=0x501,iosize=1 \
    -chardev null,id=port -device isa-parallel,chardev=port,iobase=0x378 \
    -append "console=ttyS0 quiet panic=-1 mitigations=off tsc=reliable guest.init=$init $append" \
    </dev/null >"$out/console.log" 2>&1 || qemu=$?
  local status=125
  if ((qemu == 124 || qemu == 137)); then
    status=124
  elif ((qemu == 85)) && [[ -s $out/status ]]; then  # from guest_run.sh; 0 would be a panic
    status=$(cat "$out/status")
  fi
  if ((status == 124 || status == 125)); then
    echo "guest: no status from the guest ($status); the end of its console:" >&2
    tail -n 25 "$out/console.log" >&2
  fi
  if [[ -n $temporary ]]; then
    cat "$out/log" 2>/dev/null || true
    rm -rf "$temporary"
  fi
  return "$status"
}

case ${1:-} in
  setup) [[ $# == 1 ]] || usage; setup ;;
  build) [[ $# == 1 || $* == "build --debian" ]] || usage; "$@" ;;
  run) "$@" ;;
  *) usage ;;
esac
