"""A model of building by many ranks: costs that jobs of the study `distributed` have shown, and networks that are assumed.

A rank's time in a stage is its share of the work, the bytes that it packs and sends, and what messages cost by LogGP
(alexandrov1995): a latency for each step, and at both ends an overhead for each message of it. Rounds that add numbers up take
log2 R steps (thakur2005); those that move triangles have a message between any two ranks, and go by way of a square of ranks
where these are many. Triangles, blocks and borders are dealt out as those of real models were to virtual ranks (experiment
`ranks`).
"""

import bisect
import math
from dataclasses import dataclass, field

from .result_tables import STAGES
from .values import is_number, median

HEAD = 32                       # bytes before the content of a message
PARCEL, NUMBER = 8, 8          # bytes before what a message has for or from one of several ranks; of a number told to all
ROUND_ITEMS, FEWEST_ITEMS = 2**18, 2**10
MOST_DIRECT = 48                # ranks that have a message between any two in a round, as Ranks has it
SAMPLES = 2**16                 # triangles, at least, by which the ranks' borders are chosen
BYTES_PER_CORNER = 24           # asked and answered for each distinct corner of the triangles of a round
LEVEL_RATIO = 4                 # triangles, and blocks, of a level over those of the next coarser one


@dataclass(frozen=True)
class Network:
    """Seconds of a round's latency and of a message at either end, bytes per second of a rank; `shared`: copies in the memory
    of one machine, whose costs have been measured with those of the stages."""

    name: str
    latency: float = 0
    message: float = 0
    bandwidth: float = math.inf
    shared: bool = False


HERE = Network("this machine", shared=True)
NETWORKS = [Network("10 Gb/s Ethernet, TCP", 30e-6, 5e-6, 1.1e9), Network("100 Gb/s InfiniBand", 1.5e-6, 0.5e-6, 11e9),
            Network("200 Gb/s dragonfly", 2e-6, 0.3e-6, 22e9)]


@dataclass(frozen=True)
class Job:
    """What is to be predicted; `processors`: that all of its threads share, 0: each has its own. `data`: whose order the
    input has; "": of the model that sends the most."""

    triangles: float
    ranks: int
    threads: int = 1
    processors: int = 0
    data: str = ""


def items_of(ranks):
    return max(ROUND_ITEMS / ranks, FEWEST_ITEMS)


def by_way(ranks, direct=False):
    """Whether what moves goes by way of a square of ranks, and its bytes twice; `direct`: never, and nothing by trees."""
    return ranks > MOST_DIRECT and not direct


def messages_of(fixed, growing, ranks, direct=False):
    """Messages that a rank sends in rounds that do not move triangles, and in those that do."""
    others = ranks - 1
    steps = others if direct else math.ceil(math.log2(ranks))
    return fixed * steps + growing * (2 * (math.ceil(math.sqrt(ranks)) - 1) if by_way(ranks, direct) else others)


def heads_of(fixed, growing, ranks, direct=False):
    """Bytes around the content of all ranks' messages in those rounds, and of the numbers that all are told."""
    parcels = 0 if direct else fixed * (ranks - 1) * (PARCEL + NUMBER)
    if by_way(ranks, direct):
        parcels += growing * 2 * PARCEL * min(items_of(ranks), ranks - 1)
    return ranks * (HEAD * messages_of(fixed, growing, ranks, direct) + parcels)


def latencies_of(fixed, growing, ranks, direct=False):
    """Steps that follow each other in those rounds."""
    if ranks == 1:
        return 0
    return fixed * (1 if direct else math.ceil(math.log2(ranks))) + growing * (2 if by_way(ranks, direct) else 1)


def pieces_of(job):
    """Rounds that it takes to look at all triangles of a rank."""
    return math.ceil(job.triangles / job.ranks / items_of(job.ranks))


def more_corners(job):
    """Distinct corners of a triangle of a round beyond the half that a whole surface has: rows are cut, and read twice. The
    rows are those of one of six square faces."""
    return min(math.sqrt(job.triangles / 12) / items_of(job.ranks), 0.5)


# ---- fits


def solve(matrix, right):
    """The solution of a small system, by elimination with pivots; None if it has none."""
    rows = [[*row, value] for row, value in zip(matrix, right)]
    for k in range(len(rows)):
        best = max(range(k, len(rows)), key=lambda i: abs(rows[i][k]))
        if abs(rows[best][k]) < 1e-30:
            return None
        rows[k], rows[best] = rows[best], rows[k]
        for i in range(len(rows)):
            if i != k:
                factor = rows[i][k] / rows[k][k]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
    return [row[-1] / row[k] for k, row in enumerate(rows)]


def fit(rows, values):
    """Non-negative factors whose sums of products come nearest to the values, by relative errors: least squares over all
    subsets of the factors, of which there are few."""
    rows, values = zip(*[(row, value) for row, value in zip(rows, values) if value > 0]) if any(values) else ((), ())
    count, best = len(rows[0]) if rows else 0, None
    scale = [max(abs(row[k]) for row in rows) or 1 for k in range(count)]
    for subset in range(1, 1 << count):
        used = [k for k in range(count) if subset >> k & 1]
        scaled = [[row[k] / scale[k] / value for k in used] for row, value in zip(rows, values)]
        normal = [[sum(r[a] * r[b] for r in scaled) for b in range(len(used))] for a in range(len(used))]
        found = solve(normal, [sum(r[a] for r in scaled) for a in range(len(used))])
        if found is None or min(found) < 0:
            continue
        error = sum((sum(f * x for f, x in zip(found, r)) - 1) ** 2 for r in scaled)
        if best is None or error < best[0] * (1 - 1e-9):
            best = error, {k: f / scale[k] for k, f in zip(used, found)}
    return [best[1].get(k, 0.0) for k in range(count)] if best else []


@dataclass
class Curve:
    """Medians of y over x in bins of a factor of two, and between them by the logarithms."""

    x: list = field(default_factory=list)
    y: list = field(default_factory=list)

    @classmethod
    def through(cls, points):
        bins = {}
        for x, y in points:
            bins.setdefault(round(math.log2(x)), []).append(y)
        return cls(sorted(bins), [median(bins[k]) for k in sorted(bins)])

    def at(self, x, slope_below=0.0):
        """Beyond the last bin its value; before the first one it grows with that power of x."""
        place = math.log2(x)
        if place <= self.x[0]:
            return self.y[0] * 2 ** (slope_below * (place - self.x[0]))
        if place >= self.x[-1]:
            return self.y[-1]
        k = bisect.bisect_right(self.x, place)
        share = (place - self.x[k - 1]) / (self.x[k] - self.x[k - 1])
        return self.y[k - 1] * (1 - share) + self.y[k] * share


# ---- the model


@dataclass(frozen=True)
class Prediction:
    stages: dict                # seconds by stage, and of these:
    rounds_seconds: float       # latency and messages
    first_seconds: float        # rank 0 at the tables, while the others wait
    cpu_seconds: float          # of all ranks
    bytes: float                # sent by all ranks, heads of messages included
    heads: float                # these alone
    rounds: float
    peak_bytes: float           # of a rank that is not the first
    first_peak_bytes: float     # at most: it makes the tables when it has released some of the rest
    imbalance: float

    @property
    def seconds(self):
        return sum(self.stages.values())


class Dealt:
    """How blocks are dealt out to ranks, by blocks of a level per rank; from rows of the experiment `ranks`."""

    def __init__(self, plans, cell_triangles):
        def of(setting, name):
            return setting.value(name)

        def x_of(setting):
            return of(setting, "level_blocks") / of(setting, "ranks")

        even = [s for s in plans if not of(s, "seed") and of(s, "level_blocks") >= 2]
        usual = [s for s in plans if of(s, "coarser") == 0 and of(s, "cell_triangles") == cell_triangles]
        self.finest, self.coarser = (Curve.through([(x_of(s), of(s, "level_imbalance")) for s in even
                                                    if bool(of(s, "coarser")) == coarse]) for coarse in (False, True))
        self.moved = Curve.through([(x_of(s), of(s, "moved_bytes") / of(s, "level_triangles")) for s in even if of(s, "coarser")])
        self.border = Curve.through([(x_of(s), of(s, "border_vertices") / of(s, "ranks") /
                                      math.sqrt(of(s, "input_triangles") / of(s, "ranks")))
                                     for s in even if of(s, "coarser") == 0])
        self.triangles_per_block = median([of(s, "input_triangles") / of(s, "level_blocks") for s in usual])
        self.tables = max(of(s, "first_rank_bytes") / of(s, "input_triangles") for s in usual)

    def levels(self, job):
        """(triangles, imbalance, bytes that move) by level, from the finest: as many as it takes to come to one block."""
        triangles, blocks = job.triangles, max(job.triangles / self.triangles_per_block, 1)
        while True:
            x = blocks / job.ranks
            finest = triangles == job.triangles
            curve = self.finest if finest else self.coarser
            uneven = 1.0 if job.ranks == 1 else max(1.0, min(curve.at(x, -1), job.ranks))
            yield triangles, uneven, 0 if finest or job.ranks == 1 else self.moved.at(x) * triangles
            if blocks <= 1:
                return
            triangles, blocks = triangles / LEVEL_RATIO, max(blocks / LEVEL_RATIO, 1)

    def sample_imbalance(self, job):
        """The largest of the ranks' shares over the mean, where borders are chosen by a random sample."""
        return 1 + math.sqrt(2 * math.log(max(job.ranks, 2)) * job.ranks / SAMPLES) if job.ranks > 1 else 1.0


class Model:
    """Costs by stage, from settings of the experiment `distributed`."""

    def __init__(self, jobs, plans):
        self.dealt = Dealt(plans, jobs[0].value("cell_triangles"))
        self.single = [s for s in jobs if s.value("rank_threads") == 1]
        self.cost = {stage: self.fit_cost(stage) for stage in STAGES}
        self.first = self.by_data(self.first_cost)
        self.first_bytes = self.by_data(self.first_received)
        self.rounds = {stage: fit([(1, pieces_of(self.job(s))) for s in self.single],
                                  [s.value(f"{stage}_rounds") for s in self.single]) for stage in STAGES}
        self.sent = {stage: self.by_data(lambda s, stage=stage: self.content_share(stage, s)) for stage in STAGES}
        several = [s for s in self.single if is_number(s.value("peak_bytes"))]
        self.memory = fit([(1, n / r) for n, r in map(self.size, several)], [s.value("peak_bytes") for s in several])
        self.gain = {stage: self.thread_gain(jobs, stage) for stage in STAGES}

    @staticmethod
    def size(setting):
        return setting.value("input_triangles"), setting.value("ranks")

    @staticmethod
    def job(setting):
        return Job(setting.value("input_triangles"), setting.value("ranks"), setting.value("rank_threads"),
                   setting.value("processors"), setting.value("data"))

    def work(self, stage, triangles):
        """Triangles that all ranks look at in a stage."""
        return triangles * (LEVEL_RATIO / (LEVEL_RATIO - 1) if stage == "levels" else 1)

    def fit_cost(self, stage):
        """Processor seconds for a triangle, a byte and a message."""
        rows, values = [], []
        for s in self.single:
            n, _ = self.size(s)
            rows.append((self.work(stage, n), s.value(f"{stage}_bytes"), s.value(f"{stage}_messages")))
            values.append(s.value(f"{stage}_cpu_seconds"))
        return fit(rows, values)

    def by_data(self, of):
        """Medians of a figure of jobs of several ranks, by data, and under "" the largest of them."""
        found = {}
        for s in self.single:
            if s.value("ranks") > 1:
                found.setdefault(s.value("data"), []).append(of(s))
        medians = {data: median(some) for data, some in found.items()}
        return medians | {"": max(medians.values(), default=0.0)}

    def first_cost(self, setting):
        """Seconds of rank 0 for each triangle of all ranks, beyond what another rank takes to write."""
        triangles, ranks = self.size(setting)
        own = setting.value("first_write_cpu_seconds")
        return max(own - (setting.value("write_cpu_seconds") - own) / (ranks - 1), 0.0) / triangles

    def first_received(self, setting):
        """Bytes that rank 0 gets for the tables, for each triangle of the others."""
        triangles, ranks = self.size(setting)
        return setting.value("first_write_bytes") / (triangles * (1 - 1 / ranks))

    def content_share(self, stage, setting):
        """Bytes of content for each triangle whose receiver is another rank; of `levels` over what `ranks` says; of `finest` and
        `clean`, where ranks compare what is near others, for each vertex between them. It depends on the order of the input:
        what is near in space may be near in the file, or not."""
        content = setting.value(f"{stage}_bytes") - HEAD * setting.value(f"{stage}_messages")
        return content / (2 if by_way(setting.value("ranks")) else 1) / self.could_move(stage, self.job(setting))

    def could_move(self, stage, job):
        if stage == "levels":
            return sum(moved for _, _, moved in self.dealt.levels(job)) or 1
        if stage in ("clean", "finest"):
            return self.border(job) or 1
        return job.triangles * (1 - 1 / job.ranks)

    def border(self, job):
        blocks = max(job.triangles / self.dealt.triangles_per_block, 1)
        return self.dealt.border.at(blocks / job.ranks) * math.sqrt(job.triangles * job.ranks)

    def content(self, stage, job):
        """Bytes that all ranks send, without the heads of messages."""
        if job.ranks == 1:
            return 0.0
        more = BYTES_PER_CORNER * more_corners(job) * job.triangles * (1 - 1 / job.ranks) if stage == "route" else 0
        return self.sent[stage].get(job.data, self.sent[stage][""]) * self.could_move(stage, job) + more

    def thread_gain(self, jobs, stage):
        """How much faster one rank is with two threads: the same work, by wall."""
        def seconds(threads):
            return {s.value("data"): s.value(f"{stage}_seconds") for s in jobs
                    if s.value("ranks") == 1 and s.value("rank_threads") == threads}
        one, two = seconds(1), seconds(2)
        gains = [one[data] / two[data] for data in one if data in two]
        return min(max(median(gains), 1.0), 2.0) if gains else 1.0

    def rounds_of(self, stage, job):
        """(rounds of any job, rounds that grow with the triangles)."""
        fixed, by_piece = self.rounds[stage] or (0, 0)
        return fixed, by_piece * pieces_of(job)

    def uneven(self, stage, job, sampled):
        """Triangles of the slowest rank over those of the mean."""
        if stage in ("clean", "route"):
            return 1.0
        levels = list(self.dealt.levels(job))
        by_sample = self.dealt.sample_imbalance(job) if sampled else 1.0
        if stage == "levels":
            return by_sample * sum(n * uneven for n, uneven, _ in levels) / sum(n for n, _, _ in levels)
        return by_sample * levels[0][1]

    def predict(self, job, network=HERE, direct=False, sampled=False):
        """`direct`: all rounds have a message between any two ranks. `sampled`: the input has no order in space."""
        stages, total = {}, dict.fromkeys(("waiting", "cpu", "sent", "heads", "rounds"), 0.0)
        for stage in STAGES:
            triangle, byte, message = self.cost[stage] or (0, 0, 0)
            fixed, growing = self.rounds_of(stage, job)
            messages = messages_of(fixed, growing, job.ranks, direct)
            heads = heads_of(fixed, growing, job.ranks, direct)
            sent = self.content(stage, job) * (2 if by_way(job.ranks, direct) else 1) + heads
            waiting = 0 if network.shared else (latencies_of(fixed, growing, job.ranks, direct) * network.latency +
                                                2 * messages * network.message)
            even = byte * sent + (message * messages * job.ranks if network.shared else 0)
            work = triangle * self.work(stage, job.triangles)
            threads = self.gain[stage] ** math.log2(job.threads)
            busy = (work * self.uneven(stage, job, sampled) + even) / job.ranks / threads
            if job.processors:
                busy = max(busy, (work + even) / min(job.processors, job.ranks * threads))
            stages[stage] = busy + waiting + sent / job.ranks / network.bandwidth
            for name, value in (("waiting", waiting), ("cpu", work + even), ("sent", sent), ("heads", heads),
                                ("rounds", fixed + growing)):
                total[name] += value
        first = self.first_seconds(job, network)
        stages["write"] += first
        imbalance = self.uneven("finest", job, sampled)
        base, of_triangle = self.memory or (0, 0)
        peak = base + of_triangle * job.triangles / job.ranks * imbalance
        return Prediction(stages, total["waiting"], first, total["cpu"], total["sent"], total["heads"], total["rounds"], peak,
                          peak + self.dealt.tables * job.triangles, imbalance)

    def first_seconds(self, job, network):
        """Rank 0 makes the tables of all cells, and gets what it needs for them, while the others wait."""
        if job.ranks == 1 and network.shared:
            return 0.0
        own, received = (of.get(job.data, of[""]) for of in (self.first, self.first_bytes))
        return job.triangles * (1 - 1 / job.ranks) * (own + received / network.bandwidth)
