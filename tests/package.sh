#!/usr/bin/env bash
# The Debian package of a build: package.sh BUILD_DIR.  It has the program, the manual, the
# completion, documents and examples, and names the libraries that the program wants; unpacked it
# analyses an example as the built program does.
set -euo pipefail
build=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(umask 077 && cd "$build" && cpack -G DEB -B "$folder/made") >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
package=$(echo "$folder"/made/*.deb)
dpkg -x "$package" "$folder/root"
cd "$folder/root/usr"
if dpkg -c "$package" | grep -vE '^[d-]rwxr-xr-x |^-rw-r--r-- '; then echo "are not for all"; exit 1; fi
documents=share/doc/gear3k
for file in bin/gear3k share/man/man1/gear3k.1.gz share/man/man1/gear3k-optimize.1.gz \
  share/man/man5/gear3k.5.gz share/bash-completion/completions/gear3k $documents/copyright \
  $documents/changelog.Debian.gz $documents/changelog.gz $documents/README.md \
  $documents/docs/interface.md $documents/examples/ratio-96.toml; do
  [ -f "$file" ] || { echo "no $file in the package"; exit 1; }
done
if [ -e include ] || [ -e lib ]; then echo "the library is in the package"; exit 1; fi

# dpkg-shlibdeps has found the libraries, and none is sought where this one was built.
for library in libc6 coinor-libipopt; do
  [[ " $(dpkg -f "$package" Depends)" == *" $library"* ]] || { echo "Depends: no $library"; exit 1; }
done
if objdump -p bin/gear3k | grep -E 'RPATH|RUNPATH'; then exit 1; fi

cmp <(bin/gear3k analyze $documents/examples/designs/loaded.toml --format json) \
  <("$build/gear3k" analyze $documents/examples/designs/loaded.toml --format json)

# It takes twice as long as all the rest.
if [ "${GEAR3K_LONG:-0}" = 1 ] && command -v lintian >/dev/null 2>&1; then
  lintian --fail-on error --tag-display-limit 0 "$package" 2>/dev/null
fi
