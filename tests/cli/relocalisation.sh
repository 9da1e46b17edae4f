#!/usr/bin/env bash
# What `relocalisation` refuses; its trials run in shards.sh.
. "$(dirname "$0")/support.sh"

expect 2 "--last-frame lies before" relocalisation --first-frame 9 --last-frame 8 --out b
expect 2 "expected seven-scenes:DIR" relocalisation --source kitti:here --out b
expect 3 "nowhere" relocalisation --source seven-scenes:nowhere --out b
expect 2 "--last-frame lies before" faults --first-frame 9 --last-frame 8 --out b # its former name
finish
