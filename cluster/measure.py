#!/usr/bin/env python3
"""What ranks cost, and what more of them would: the tables of doc/measured/cluster.md.

usage: cluster/measure.py [--runs N] [--ranks P,P,...] [CASE.nml [KINDS.nml]]     (scripts/cluster --measure builds what it needs)

Measures the items of a search (CASE; default: data/line6.nml with 4000 starts) and of a search over kinds (KINDS; default:
cluster/square.nml with 4 starts of each assembly) in one process, what ranks of this machine need for a counter, a barrier and an
exchange, and runs of 1, 2, 4, 7 and 64 ranks. From these: a model of cost, a simulation of the schedule with the measured times, and
what both say for 10, 1000 and 100 000 ranks. Figures of a network, which this machine has not, are assumed: see NETWORK.
"""
import argparse
import bisect
import heapq
import json
import math
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BUILT = os.path.join(TOP, "build", "cluster")
CORES = os.cpu_count()

# assumed, not measured: an InfiniBand cluster. Seconds of a message, bytes a second into a rank, seconds that a rank waits for a
# portion of the counter, and that the counter is busy with one
NETWORK = {"message": 2.0e-6, "bandwidth": 1.0e10, "portion": 3.0e-6, "counter": 5.0e-7}
WANTED = 0.9                 # efficiency
OWN_NUMBERS = 2              # that go with an item in an exchange: its number, how many there are
FINER = 2                    # as in cluster/psalm_team.f90
MPI = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
       "OMPI_MCA_mpi_yield_when_idle": "1"}


class Batch:
    def __init__(self, label, items):
        self.label, self.items, self.times, self.numbers, self.gap = label, items, [], [], 0.0


def work_of(case):
    """The batches of a case, and the seconds that belong to no item and no gap between two batches of starts."""
    with tempfile.TemporaryDirectory() as place:
        shutil.copy(case, os.path.join(place, "c.nml"))
        subprocess.run([os.path.join(BUILT, "timed", "bin", "psalm-timed"), "--quiet", "c.nml"], cwd=place, stdout=subprocess.DEVNULL)
        with open(os.path.join(place, "work.times"), encoding="ascii") as file:
            lines = [line.split() for line in file]
    batches, closed = [], None
    for line in lines:
        if line[0] == "open":
            if closed is not None:
                batches[-1].gap = float(line[1]) - closed
            batches.append(Batch(line[2], int(line[3])))
        elif line[0] == "item":
            batches[-1].times.append(float(line[2]))
            batches[-1].numbers.append(int(line[3]))
        elif line[0] == "close":
            closed = float(line[1])
    total = float(lines[-1][1])
    batches = [b for b in batches if b.times]
    rest = total - sum(sum(b.times) + b.gap for b in batches)
    return batches, rest, total


class Spread:
    """The times of items: mean, deviation, and what is left of those in progress when nothing more is handed out."""

    def __init__(self, times):
        self.times = sorted(times)
        n = len(times)
        self.mean = sum(times)/n
        self.deviation = math.sqrt(sum((t - self.mean)**2 for t in times)/n)
        # the distribution of what is left of an item met in progress (renewal theory): (sum of min(t, x))/(n mean), at each time
        self.left, below = [], 0.0
        for i, t in enumerate(self.times):
            below += t
            self.left.append((below + (n - 1 - i)*t)/(n*self.mean))
        self.mean_left = sum(t*t for t in times)/(2.0*n*self.mean)

    def longest_left(self, ranks):
        """Expected maximum of what is left of the items of so many ranks."""
        expected, before = 0.0, 0.0
        for t, share in zip(self.times, self.left):
            expected += (t - before)*(1.0 - share**ranks)
            before = t
        return expected

    def tail(self, ranks):
        """Seconds by which the last rank ends after the mean of all (Kruskal and Weiss, 1985)."""
        return max(0.0, self.longest_left(ranks) - self.mean_left)


def portions_of(items, ranks):
    upto = 0
    while upto < items:
        size = max(1, (items - upto)//(FINER*ranks))
        upto += size
        yield size


def collective(ranks, items, numbers):
    """Seconds of the barrier, the agreements and the exchange of a round on the network."""
    stages = math.ceil(math.log2(ranks)) if ranks > 1 else 0
    return 5*stages*NETWORK["message"] + (items*8*numbers/NETWORK["bandwidth"] if ranks > 1 else 0.0)


def counter_time(items, ranks):
    """Seconds that the counter is busy in a round: it serves one portion after another."""
    singles = min(items, FINER*ranks)
    portions = singles + (FINER*ranks*math.log(items/singles) if items > singles else 0.0)
    return portions*NETWORK["counter"]


def model(spread, ranks, items, gap, each, numbers):
    """Seconds of a round. gap: seconds between two rounds, each: seconds more for every item."""
    work = max(items*spread.mean/ranks + spread.tail(ranks), counter_time(items, ranks))
    return work + gap + each*items + collective(ranks, items, numbers)


def simulate(times, ranks, items, gap, each, numbers, seed=1):
    """The same by the schedule itself: portions, one counter, times drawn from those measured."""
    draw = random.Random(seed)
    pick = draw.choice
    free = [(0.0, rank) for rank in range(ranks)]
    served, last = 0.0, 0.0
    for size in portions_of(items, ranks):
        now, rank = heapq.heappop(free)
        served = max(now, served) + NETWORK["counter"]
        done = max(now + NETWORK["portion"], served) + sum(pick(times) for _ in range(size))
        last = max(last, done)
        heapq.heappush(free, (done, rank))
    return last + gap + each*items + collective(ranks, items, numbers)


def simulate_here(batches, rest, ranks, here, cores=CORES):
    """Seconds of a run of so many ranks on few cores, which are divided equally among those that work."""
    def slow(active):
        return max(1.0, active/cores)
    seconds = rest*slow(ranks)
    for batch in batches:
        times = iter(batch.times)
        portions = portions_of(len(batch.times), ranks)
        virtual, active, left = 0.0, [], ranks
        for _ in range(ranks):
            size = next(portions, 0)
            work = sum(next(times) for _ in range(size))
            heapq.heappush(active, work)
        while active:
            ended = heapq.heappop(active)
            seconds += (ended - virtual)*slow(left)
            virtual = ended
            size = next(portions, 0)
            if size:
                heapq.heappush(active, virtual + sum(next(times) for _ in range(size)))
            else:
                left -= 1
        count = sum(batch.numbers) + OWN_NUMBERS*len(batch.numbers)
        seconds += batch.gap*slow(ranks) + 5*here["barrier"] + exchange_here(here, 8*count/ranks)
    return seconds


def exchange_here(here, each):
    """Seconds of the exchange of so many bytes of each rank: between those measured, and in proportion beyond."""
    sizes, seconds = here["bytes"], here["exchange"]
    k = min(bisect.bisect(sizes, each), len(sizes) - 1)
    if k == 0:
        return seconds[0]
    share = (each - sizes[k - 1])/(sizes[k] - sizes[k - 1])
    return max(seconds[k - 1], seconds[k - 1] + share*(seconds[k] - seconds[k - 1]))


def shortest(spread, ranks, gap, each, numbers):
    """Items a rank that a round must have for the efficiency wanted; none: no round is long enough."""
    def efficiency(items):
        return items*spread.mean/(ranks*model(spread, ranks, items, gap, each, numbers))
    low, high = 1, 2
    while efficiency(high*ranks) < WANTED:
        low, high = high, 2*high
        if high > 2**30:
            return None
    while high - low > max(1, low//1000):
        middle = (low + high)//2
        low, high = (low, middle) if efficiency(middle*ranks) >= WANTED else (middle, high)
    return high


def latency(ranks):
    done = subprocess.run(["mpiexec.openmpi", "-n", str(ranks), os.path.join(BUILT, "openmpi", "bin", "latency")], env=MPI,
                          capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def run(case, ranks, program="psalm-mpi"):
    """Seconds of a run, of all of its processors."""
    with tempfile.TemporaryDirectory() as place:
        shutil.copy(case, os.path.join(place, "c.nml"))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        begun = time.time()
        if program == "psalm":
            command = [os.path.join(TOP, "build", "local", "bin", "psalm")]
        else:
            command = ["mpiexec.openmpi", "-n", str(ranks), os.path.join(BUILT, "openmpi", "bin", program)]
        subprocess.run([*command, "--quiet", "c.nml"], cwd=place, env=MPI, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        seconds = time.time() - begun
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return seconds, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def changed(case, place, old, new):
    """The case with other text."""
    with open(case, encoding="utf-8") as file:
        text = file.read()
    assert old in text, (case, old)
    name = os.path.join(place, os.path.basename(case))
    with open(name, "w", encoding="utf-8") as file:
        file.write(text.replace(old, new))
    return name


def milliseconds(seconds):
    return "%.3g" % (1e3*seconds)


def measure_items(batches, label):
    times = [t for b in batches if b.label == label for t in b.times]
    numbers = [n for b in batches if b.label == label for n in b.numbers]
    return times, sum(numbers)/len(numbers) + OWN_NUMBERS


def gaps_of(few, many):
    """Seconds between two rounds: a constant and a part for every item, from a run of few and one of many starts."""
    def mean(batches):
        rounds = [b for b in batches if b.label == "starts"]
        return sum(b.gap for b in rounds)/len(rounds), sum(b.items for b in rounds)/len(rounds)
    (gap_few, few_items), (gap_many, many_items) = mean(few), mean(many)
    each = max(0.0, (gap_many - gap_few)/(many_items - few_items))
    return max(0.0, gap_few - each*few_items), each


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3, help="the least of so many runs counts")
    parser.add_argument("--ranks", default="1,2,4,7,64")
    parser.add_argument("case", nargs="?")
    parser.add_argument("kinds", nargs="?")
    asked = parser.parse_args()
    place = tempfile.mkdtemp()
    case = asked.case or changed(os.path.join(TOP, "data", "line6.nml"), place, "NSTART=1000 ", "NSTART=4000 ")
    kinds = asked.kinds or changed(os.path.join(TOP, "cluster", "square.nml"), place, "NSTART=273", "NSTART=4")
    few, _, _ = work_of(changed(case, tempfile.mkdtemp(dir=place), "NSTART=4000 ", "NSTART=400 ") if not asked.case else case)
    batches, rest, total = work_of(case)
    starts, numbers = measure_items(batches, "starts")
    gap, each = gaps_of(few, batches)
    kind_batches, kind_rest, kind_total = work_of(kinds)
    kind_starts, kind_numbers = measure_items(kind_batches, "kinds")
    screenings, _ = measure_items(kind_batches, "screenings")
    kind_gap = sum(b.gap for b in kind_batches if b.label == "kinds")/sum(1 for b in kind_batches if b.label == "kinds")
    out = print
    out("## Items\n\nSeconds of the processor in one process (`psalm-timed`).\n")
    out("| item | measured | mean, ms | standard deviation, ms | longest, ms | bytes of a result |\n| --- | --- | --- | --- | --- | --- |")
    spreads = {}
    for name, times, count in (("start of a four-bar", starts, numbers), ("start of a six- or eight-bar", kind_starts, kind_numbers),
                               ("screening of an assembly", screenings, kind_numbers)):
        spread = spreads[name] = Spread(times)
        out("| %s | %d | %s | %s | %s | %d |" % (name, len(times), milliseconds(spread.mean), milliseconds(spread.deviation),
                                                milliseconds(spread.times[-1]), round(8*count)))
    out("\nBetween two rounds of starts every rank ranks all results: %s ms and %.2f microseconds for each start. Between two rounds of kinds: %s ms."
        % (milliseconds(gap), 1e6*each, milliseconds(kind_gap)))
    out("Outside all rounds (reading, drawing, listing): %.2f s of %.2f s for the four-bar, %.2f s of %.2f s for the kinds.\n"
        % (rest, total, kind_rest, kind_total))

    out("## Rounds on this machine\n\nOpen MPI, %d cores, microseconds.\n" % CORES)
    counts = [int(p) for p in asked.ranks.split(",")]
    here = {p: latency(p) for p in counts}
    out("| ranks | portion from the counter | barrier | exchange of 64 bytes a rank | of 8 kB | of 512 kB |\n| --- | --- | --- | --- | --- | --- |")
    for p in counts:
        out("| %d | %.3g | %.3g | %.3g | %.3g | %.3g |" % (p, *(1e6*x for x in (here[p]["counter"], here[p]["barrier"], *here[p]["exchange"]))))

    out("\n## More ranks\n")
    out("| item | ranks | shortest round, starts a rank | starts of the round | efficiency, model | efficiency, simulated | tail, ms "
        "| exchange, ms | ranking, ms |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, of_each, count, constant in (("start of a four-bar", each, numbers, gap),
                                           ("start of a six- or eight-bar", each, kind_numbers, kind_gap)):
        spread = spreads[name]
        for p in (10, 1000, 100000):
            length = shortest(spread, p, constant, of_each, count)
            items = p*(length or 100)
            expected = items*spread.mean/(p*model(spread, p, items, constant, of_each, count))
            draws = range(max(1, 2000//p)) # short rounds spread
            seconds = sum(simulate(spread.times, p, items, constant, of_each, count, seed) for seed in draws)/len(draws)
            simulated = items*spread.mean/(p*seconds)
            out("| %s | %d | %s | %d | %.3f | %.3f | %s | %s | %s |" % (
                name, p, length or "none; 100", items, expected, simulated, milliseconds(spread.tail(p)),
                milliseconds(collective(p, items, count)), milliseconds(of_each*items)))
    spread = spreads["start of a six- or eight-bar"]
    out("\nRanks for which no round is long enough (efficiency 0.9): four-bar %d, six- and eight-bars %d."
        % tuple(most_ranks(s.mean, each, c) for s, c in ((spreads["start of a four-bar"], numbers), (spread, kind_numbers))))
    out("\n## 10 000 000 starts over all six- and eight-bars\n")
    whole = 1e7*spread.mean
    out("%.0f core hours (%s ms a start).\n" % (whole/3600, milliseconds(spread.mean)))
    out("| ranks | starts a rank and round, 8 rounds | efficiency, model | hours |\n| --- | --- | --- | --- |")
    for p in (CORES, 10, 1000, 100000):
        seconds = kind_rest + 8*model(spread, p, 1.25e6, kind_gap, each, kind_numbers)
        out("| %d | %.1f | %.3f | %.4g |" % (p, 1.25e6/p, whole/(p*seconds), seconds/3600))
    out("\n## Runs on this machine\n\nThe four-bar, the least of %d runs; %d cores, which other work used too (load %.1f).\n"
        % (asked.runs, CORES, os.getloadavg()[0]))
    out("| ranks | seconds | simulated | of the processor | efficiency by the processor | efficiency by the clock |\n| --- | --- | --- | --- | --- | --- |")
    tiny = changed(case, tempfile.mkdtemp(dir=place), "NSTART=4000 ", "NSTART=1 ") if not asked.case else None
    alone = min(run(case, 1, "psalm") for _ in range(asked.runs))
    least = min(run(case, 1, "psalm")[1] for _ in range(asked.runs))
    out("| one process | %.2f | %.2f | %.2f | | |" % (alone[0], total, least))
    for p in counts:
        runs = [run(case, p) for _ in range(asked.runs)]
        begin = min(run(tiny, p)[0] for _ in range(asked.runs)) if tiny else 0.0
        seconds, processor = min(r[0] for r in runs), min(r[1] for r in runs)
        expected = simulate_here(batches, 0.0, p, here[p]) + begin
        out("| %d | %.2f | %.2f | %.2f | %.2f | %.2f |" % (p, seconds, expected, processor, least/processor,
                                                         alone[0]/(min(p, CORES)*seconds)))
    shutil.rmtree(place)


def most_ranks(mean, each, numbers):
    """Ranks up to which a round can be long enough: what every rank does for every item, against the rank's part of the work."""
    return int((1.0/WANTED - 1.0)*mean/(each + 8*numbers/NETWORK["bandwidth"]))


if __name__ == "__main__":
    main()
