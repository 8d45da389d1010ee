#!/bin/sh
# Compiles German's conventions: comma_locale.sh LOCALEDEF FOLDER.made. FOLDER stays empty where
# their sources are not installed (Debian: locales).
folder=${2%.made}
rm -rf "$folder"
mkdir -p "$folder"
"$1" -i de_DE -f UTF-8 "$PWD/$folder" >/dev/null 2>&1
touch "$2"
