#!/bin/bash
# The bits of AVX-512 on a machine without it: avx512.sh PROGRAM LIBRARY FOLDER. A kernel of Debian's boots in Bochs,
# which emulates a processor that has it, and small scenes run by every instruction set; state hash and energies must be
# equal.
# Five minutes. Needs of Debian: bochs bochsbios vgabios bochs-term isolinux syslinux-common genisoimage busybox-static
# cpio lz4, and apt-get download for the kernel.
set -eu
program=$(realpath "$1") library=$(realpath "$2")
mkdir -p "$3/disk/bin" "$3/iso/isolinux"; cd "$3"

if [ ! -f iso/vmlinuz ]; then
  apt-get download "$(apt-cache depends linux-image-cloud-amd64 | sed -n 's/.*Depends: //p')"
  dpkg -x linux-image-*.deb kernel
  cp kernel/boot/vmlinuz-* iso/vmlinuz
fi
cp /bin/busybox disk/bin/; cp "$program" disk/bin/epafi; cp -r "$library" disk/library
ldd "$program" | grep -o '/[^ ]*' | while read -r file; do
  mkdir -p "disk$(dirname "$file")"
  cp -L "$file" "disk$file"
done

cat > disk/init <<'EOF'
#!/bin/busybox sh
/bin/busybox mkdir -p /proc /dev /tmp /usr/bin
/bin/busybox --install -s /usr/bin
export PATH=/usr/bin:/bin OMP_NUM_THREADS=1
mount -t proc proc /proc; mount -t devtmpfs dev /dev
exec > /dev/ttyS0 2>&1
grep -q avx512dq /proc/cpuinfo && echo "FOUND AVX-512"
run() { # NAME SCENE STEPS OVERRIDES...
  local name=$1 scene=$2 steps=$3 sets= target; shift 3
  for o in "$@"; do sets="$sets --set $o"; done
  for target in baseline avx2 avx512; do
    EPAFI_TARGET=$target epafi run /library/$scene $sets --steps $steps -t 1 -q --force --least-output -o /tmp/run
    figures=$(grep -E '"(kinetic|elastic|dissipated|state_hash)"' /tmp/run/summary.json | tr -d ' \n')
    echo "RAN $name: $figures by $target"
  done
}
run bed bed/bed.toml 1200 params.n=150
run rolling bed/bed.toml 3000 params.n=150 run.time_step=1.9e-5 contact.smooth.rolling=spring \
  contact.rolling_friction=0.1 contact.smooth.tangential=mindlin-dashpot
run cell granular/jammed_spheres.toml 1500 params.n=80 params.start=0.12 params.mu=0.3 params.softness=1e-2 \
  params.first=1e-2 params.ramp=1 world.domain.rate_limit=8.0 run.duration=8
run stack stacking/stack.toml 20
run arch stability/arch.toml 10
echo "DONE"
sleep 1000
EOF
chmod +x disk/init
(cd disk; find . | cpio -o -H newc --quiet | lz4 -l -9 -q > ../iso/initrd)

cp /usr/lib/ISOLINUX/isolinux.bin /usr/lib/syslinux/modules/bios/ldlinux.c32 iso/isolinux/
# 321 and 323: XSAVEC and XSAVES, whose area Bochs 2.7 says is larger than it is; the kernel would do without AVX then
options="nosmp noapic acpi=off nokaslr nopti mitigations=off tsc=reliable lpj=4000000 clearcpuid=321,323"
cat > iso/isolinux/isolinux.cfg <<EOF
default epafi
label epafi
  kernel /vmlinuz
  append initrd=/initrd console=ttyS0 $options
EOF
genisoimage -quiet -o boot.iso -b isolinux/isolinux.bin -c isolinux/boot.cat -no-emul-boot -boot-load-size 4 \
  -boot-info-table iso
cat > bochsrc <<'EOF'
plugin_ctrl: unmapped=1, biosdev=1, speaker=0, extfpuirq=1, parallel=0, serial=1
config_interface: textconfig
display_library: rfb, options="timeout=0"
megs: 1024
cpu: model=corei7_skylake_x, count=1, ips=50000000, ignore_bad_msrs=1
romimage: file=/usr/share/bochs/BIOS-bochs-latest
vgaromimage: file=/usr/share/bochs/VGABIOS-lgpl-latest
ata0: enabled=1, ioaddr1=0x1f0, ioaddr2=0x3f0, irq=14
ata0-master: type=cdrom, path=boot.iso, status=inserted
boot: cdrom
com1: enabled=1, mode=file, dev=serial.txt
log: bochs.log
panic: action=fatal
error: action=ignore
info: action=ignore
EOF
rm -f serial.txt; echo c > go
bochs -q -f bochsrc -rc go > bochs.out 2>&1 < /dev/null &
emulator=$!
until grep -aq "^DONE" serial.txt 2> /dev/null; do
  jobs -r | grep -q . || break
  sleep 5
done
kill $emulator 2> /dev/null || true
grep -aE "^(FOUND|RAN)" serial.txt | tr -d '\r'

bad=0
grep -aq "^FOUND AVX-512" serial.txt || { echo "FAILED: no AVX-512"; bad=1; }
grep -aq "^DONE" serial.txt || { echo "FAILED: it did not end: $(tail -c 300 serial.txt)"; bad=1; }
for name in bed rolling cell stack arch; do
  lines=$(grep -aE "^RAN $name:.*state_hash" serial.txt | tr -d '\r' | sed 's/ by .*//')
  [ "$(echo "$lines" | grep -c .)" = 3 ] && [ "$(echo "$lines" | sort -u | wc -l)" = 1 ] ||
    { echo "FAILED: $name"; bad=1; }
done
exit $bad
