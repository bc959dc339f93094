#!/bin/sh
# Nasty scenes, as many as asked for, a shard at a time: what is done stays done when this is
# stopped, and is not done again. Each shard leaves a line of CSV and what was wrong; in the end,
# or with --sums alone, the sums (of `backward_` columns the largest) are printed.
#   million.sh PROGRAM DIRECTORY [--precision NAME] [--first N] [--scenes N] [--sums]
set -e
program=$1 directory=$2 precision=auto first=0 scenes=1000000 shard=10000 sums=
shift 2
while [ $# -gt 0 ]; do
    case $1 in
    --precision) precision=$2 && shift 2 ;;
    --first) first=$2 && shift 2 ;;
    --scenes) scenes=$2 && shift 2 ;;
    --sums) sums=only && shift ;;
    *) echo "what is $1?" >&2 && exit 2 ;;
    esac
done
mkdir -p "$directory"
end=$((first + scenes))
while [ -z "$sums" ] && [ "$first" -lt "$end" ]; do
    count=$((end - first < shard ? end - first : shard))
    name=$directory/$precision-$first-$count
    # 1 says that something does not hold, which is what the sums are for.
    [ -f "$name.csv" ] ||
        "$program" --case nasty --precision "$precision" --first "$first" --scenes "$count" \
            --verbose --csv "$name.part" >"$name.txt" || [ $? -eq 1 ]
    [ -f "$name.csv" ] || mv "$name.part" "$name.csv"
    first=$((first + count))
done
cat "$directory/$precision"-*.csv | awk -F, '
    $1 == "case" { for (i = 1; i <= NF; i++) name[i] = $i; columns = NF - 2; next }
    { for (i = 3; i <= columns; i++)
          if (name[i] !~ /^backward|lift|forward|relative|condition/) value[i] += $i
          else if ($i + 0 > value[i]) value[i] = $i + 0 }
    END { for (i = 3; i <= columns; i++) printf "%s %.15g\n", name[i], value[i] }'
