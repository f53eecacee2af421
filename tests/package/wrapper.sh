#!/bin/bash
# The wrapper ./epafi builds only what changed and says nothing where nothing did: wrapper.sh WRAPPER FOLDER
# A tree of empty folders; stand-ins record the calls of dpkg-query, cmake and ninja.
set -u
folder=$2
rm -rf "$folder"
mkdir -p "$folder"/bin "$folder"/tree/{cmake,engine/state,detection,laws,ranks,viz_export,scenes/library}
cp "$1" "$folder/tree/epafi"
touch "$folder/tree/CMakeLists.txt"
cat > "$folder/bin/dpkg-query" <<'END'
#!/bin/bash
echo dpkg-query >> "$RECORD"
for name in "${@:3}"; do echo "$name install ok installed"; done
END
cat > "$folder/bin/cmake" <<'END'
#!/bin/bash
echo cmake >> "$RECORD"
touch "$4/build.ninja"
END
cat > "$folder/bin/ninja" <<'END'
#!/bin/bash
echo "ninja $3" >> "$RECORD"
[ ! -f "$BROKEN" ] || { echo "error: broken"; exit 1; }
mkdir -p "$2/bin"
printf '#!/bin/sh\necho "program $*"\n' > "$2/bin/$3"
chmod +x "$2/bin/$3"
END
chmod +x "$folder"/bin/*
export PATH=$folder/bin:$PATH RECORD=$folder/record BROKEN=$folder/broken
unset EPAFI_BUILD
bad=0
expect() { # what happened, calls wanted, exit code wanted, lines of its own wanted
  : > "$RECORD"
  "$folder/tree/epafi" list shapes > "$folder/out" 2> "$folder/err"
  local code=$? calls
  calls=$(tr '\n' ' ' < "$RECORD")
  [ "$calls" = "$2" ] || { echo "FAILED: $1: calls '$calls', not '$2'"; bad=1; }
  [ $code = "$3" ] || { echo "FAILED: $1: exit code $code"; bad=1; }
  [ $code != 0 ] || [ "$(cat "$folder/out")" = "program list shapes" ] || { echo "FAILED: $1: no program"; bad=1; }
  # a build of more than a second says so, which a busy machine may take
  [ "$(grep -cv "building (Release)" "$folder/err")" = "$4" ] || { echo "FAILED: $1: $(cat "$folder/err")"; bad=1; }
  [ -n "$2" ] || [ ! -s "$folder/err" ] || { echo "FAILED: $1: it says $(cat "$folder/err")"; bad=1; }
  sleep 0.02  # time stamps of files are those of the last tick of the clock
}
whole="dpkg-query ninja epafi "
expect "fresh clone" "dpkg-query cmake ninja epafi " 0 1
expect "after the set-up" "" 0 0
touch "$folder/tree/engine/state/world.h"
expect "new file" "$whole" 0 0
expect "after it" "" 0 0
touch "$folder/tree/engine/state/world.h" "$folder/broken"
expect "file that does not compile" "$whole" 3 1
expect "still broken" "$whole" 3 1
rm "$folder/broken"
expect "mended" "$whole" 0 0
rm "$folder/tree/engine/state/world.h"
expect "file removed" "$whole" 0 0
touch "$folder/tree/scenes/library/new.toml"
expect "new scene" "" 0 0
touch "$folder/tree/build/build.ninja"
expect "configured by hand" "$whole" 0 0
rm "$folder/tree/build/bin/epafi"
expect "program removed" "$whole" 0 0
rm -r "$folder/tree/laws"
expect "folder that cannot be read" "$whole" 0 0
exit $bad
