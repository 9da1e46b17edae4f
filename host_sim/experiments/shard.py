"""Parts of an ensemble of runs, as `--shard i/n` of cairn_sim: each part does every nth run and leaves it in the common
folder; the script without --shard, over the same folder, does what is missing and makes the tables."""
import argparse


def add_shard_option(parser):
    parser.add_argument("--shard", type=parse_shard, default=(1, 1), metavar="I/N",
                        help="do part I of N of the runs and make no table")


def parse_shard(text):
    try:
        index, count = (int(part) for part in text.split("/"))
    except ValueError:
        index, count = 0, 0
    if not 1 <= index <= count:
        raise argparse.ArgumentTypeError(f"'{text}': expected i/n with 1 <= i <= n, for example 3/8")
    return index, count


def of_shard(runs, shard):
    """The runs that the part does."""
    index, count = shard
    return runs[index - 1::count]
