#!/bin/sh
# SPDX-License-Identifier: MIT
# no_globals.sh OBJDUMP ARCHIVE...: fails, and names them, if an archive has variables of static storage:
# writable data, zeroed or not, or data of a thread. Constants that hold addresses (.data.rel.ro), the
# compiler's reference to its exception handler, and one text of 512 bytes a thread (a file that cannot be
# opened, formats/src/source.cpp) are allowed.
objdump=$1
shift
"$objdump" -h "$@" | awk '
  /file format/ { object = $1 }
  $2 ~ /^\.(data|bss|tdata|tbss)/ && $2 !~ /^\.data\.rel\.ro/ && $2 !~ /DW\.ref\.__gxx_personality/ &&
    $3 !~ /^0+$/ && !($2 ~ /^\.tbss/ && $3 == "00000200" && texts++ == 0) { print object, $2, $3; bad = 1 }
  /file format/ { objects++ }
  END { exit bad || !objects }'
