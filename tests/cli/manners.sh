#!/usr/bin/env bash
# Words that are almost right, help, completion, and what stands in a folder already.
. "$(dirname "$0")/support.sh"

expect 2 "unknown command 'runn'|did you mean 'run'?" runn hall
expect 2 "unknown command 'calbrate'|did you mean 'calibrate'?" calbrate
expect 2 "unknown command 'xyzzy'|expected one of run, " xyzzy
[[ $output != *"did you mean"* ]] || fail "a suggestion for xyzzy: $output"
expect 2 "run: unknown option '--camrea'|did you mean '--camera'?" run hall --camrea c.yaml --out out
expect 2 "'--oout'|did you mean '--out'?" run hall --oout=x
expect 2 "source 'hal'|did you mean 'hall'?" run hal --out out
expect 2 "source 'kiti:x'|did you mean 'kitti'?" run kiti:x --out out
expect 0 "Subcommands|calibrate|completion" help
expect 0 "--max-frames" help run
expect 2 "unknown command 'rum'|did you mean 'run'?" help rum
expect 0 "cairn_sim" --version
expect 2 "unknown command 'version'|did you mean '--version'?" version
expect 2 "--filter: expected one of group-iekf, |found 'efk'; did you mean 'ekf'?" run hall --filter efk --out out
expect 2 "--mode: expected one of vehicle, handheld, found 'xyzzy'" run hall --mode xyzzy --out out
[[ $output != *"did you mean"* ]] || fail "a suggestion for xyzzy: $output"
expect 2 "source 'euroc:': expected euroc:DIR" run euroc: --out out
expect 2 "--max-frames: expected a whole number above zero, found '2.5'" run hall --max-frames 2.5 --out out
expect 2 "--max-frames: expected a whole number above zero, found '1e400'" run hall --max-frames 1e400 --out out
expect 2 "--crop 9999x9999: expected a part" run hall-small --crop 9999x9999 --out out
expect 2 "--hfov: a guess in place of" run video:. --camera c.yaml --hfov 60 --out out
expect 2 "--focal-sigma: only for --mode handheld" run hall-small --focal-sigma 0.1 --out out

# completion: what the shell's function offers for a line whose last word is being typed
offers() { # WORD... EXPECTED (words that must be there)
  local expected=${*: -1} words=("${@:1:$#-1}")
  local got
  got=$(bash --norc -c '. "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _cairn_sim; echo "${COMPREPLY[*]}"' \
    _ "$work/completion" "${words[@]}" 2>&1)
  for word in $expected; do
    [[ " $got " == *" $word "* ]] || fail "completing '${words[*]}' does not offer $word: $got"
  done
}
expect 0 "complete " completion bash
printf '%s\n' "$output" >"$work/completion"
bash -n "$work/completion" || fail "the script for bash"
offers cairn_sim ca "calibrate"
offers cairn_sim "" "run timing help completion"
offers cairn_sim run --o "--out --odometry --overlay"
offers cairn_sim run --mode "" "vehicle handheld"
offers cairn_sim run h "hall hall-small"
offers cairn_sim run k "kitti:"
offers cairn_sim calibrate --board c "chessboard charuco"
offers cairn_sim help tur "turntable"
expect 0 "bashcompinit" completion zsh
if command -v zsh >/dev/null; then
  printf '%s\n' "$output" >"$work/completion.zsh"
  zsh -f -c "autoload -U compinit && compinit -u -D && . '$work/completion.zsh'" || fail "the script for zsh"
fi
expect 2 "bash, zsh" completion fish

# where a result could not be written is said before the work
expect 4 "nowhere/faults.csv: cannot be written" inject hall-small --brief --out nowhere/faults.csv
[[ $output != *F01* ]] || fail "inject worked before it said so: $output"

# results go into a folder of their own
mkdir "$work/mine"
touch "$work/mine/notes.txt"
expect 2 "--out mine|holds files already|--force" run hall-small --max-frames 2 --out mine
expect 0 "log hash" run hall-small --max-frames 2 --no-video --force --out mine
[ -e "$work/mine/notes.txt" ] || fail "--force removed a user's file"
mkdir "$work/empty"
expect 0 "log hash" run hall-small --max-frames 2 --no-video --out empty
finish
