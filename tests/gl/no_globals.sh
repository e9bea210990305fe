#!/bin/sh
# SPDX-License-Identifier: MIT
# no_globals.sh OBJDUMP ARCHIVE...: fails, with their names, if an archive has variables of static storage: data that may be written, zeroed
# or not, or of a thread. Constants that hold addresses (.data.rel.ro) are none; the compiler's reference to its exception handler is none.
objdump=$1
shift
"$objdump" -h "$@" | awk '
  /file format/ { object = $1 }
  $2 ~ /^\.(data|bss|tdata|tbss)/ && $2 !~ /^\.data\.rel\.ro/ && $2 !~ /DW\.ref\.__gxx_personality/ && $3 !~ /^0+$/ { print object, $2, $3; bad = 1 }
  /file format/ { objects++ }
  END { exit bad || !objects }'
