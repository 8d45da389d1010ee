"""Swaths made of speckle whose curve, looks, ceiling and noise floor are known."""

import numpy

ROWS, COLUMNS = 768, 800
WIDTH = 1.5  # half-power width of the response, pixels
LEVEL_DB = 2.0  # standard deviation of the seabed's level, dB
# each kind's parameter, and the seabed's median amplitude over full scale
KINDS = {"amplitude": (None, 0.12), "intensity": (None, 0.25), "gamma": (1.7, 0.08),
         "schlick": (3.0, 0.2), "decibel": (None, 0.1)}


def _smooth(noise, deviation):
    """Convolves with a Gaussian of that standard deviation, pixels. Opposite edges are joined."""
    rows = numpy.fft.fftfreq(noise.shape[0])[:, None]
    columns = numpy.fft.fftfreq(noise.shape[1])[None, :]
    weights = numpy.exp(-2 * (numpy.pi * deviation) ** 2 * (rows**2 + columns**2))
    return numpy.fft.ifft2(numpy.fft.fft2(noise) * weights)


def _field(random, shape, width=WIDTH):
    """Returns a circular Gaussian field of mean square 1, as a Gaussian response of that width makes it."""
    noise = random.standard_normal(shape) + 1j * random.standard_normal(shape)
    field = _smooth(noise, width / (2 * numpy.log(2) ** 0.5))
    return field / numpy.mean(numpy.abs(field) ** 2) ** 0.5


def speckle(seed, textures=None, gain_db=0.0, schlick=1.0, width=WIDTH):
    """Returns numbers of one level by a Schlick curve. Intensities are K distributed with the shape
    textures / 2. The gain changes by gain_db over the columns. width: the response's, pixels."""
    random = numpy.random.default_rng(seed)
    shape = (512, 600)
    intensity = numpy.abs(_field(random, shape, width)) ** 2 * 10 ** (gain_db / 10 * numpy.arange(600) / 600)
    if textures:
        squares = (_smooth(random.standard_normal(shape), 10.0).real ** 2 for _ in range(textures))
        intensity *= sum(square / square.mean() for square in squares) / textures
    a = 0.12 * intensity**0.5
    return numpy.clip(numpy.round(60000 * schlick * a / (1 + (schlick - 1) * a)), 0, 60000).astype(numpy.uint16)


def sidescan(shadow_db=None, water_db=-30.0, water=100, seed=1):
    """Returns amplitudes of a waterfall of two sides with the nadir in the middle. Water reaches up to the
    first return. Shadows of stones, 6 to 14 pings long, differ by shadow_db from the seabed; None: no shadow."""
    random = numpy.random.default_rng(seed)
    shape = (480, 1000)
    level = _smooth(random.standard_normal(shape), 40.0).real
    level = 10 ** (level * LEVEL_DB / level.std() / 10)
    off = numpy.abs(numpy.arange(1000) - 499.5)
    for number in range(24 if shadow_db is not None else 0):
        row, column = 20 + number // 4 * 75, (40, 270, 640, 860)[number % 4]
        rows, columns = random.integers(6, 15), random.integers(30, 60)
        level[row : row + rows, column : column + columns] *= 10 ** (shadow_db / 10)
    level[:, off < water] = 10 ** (water_db / 10)
    amplitude = 4000 * level**0.5 * numpy.abs(_field(random, shape))
    return numpy.clip(numpy.round(amplitude), 0, 65535).astype(numpy.uint16)


class Made:
    """A made swath. `numbers` are its stored pixels of 8 or 16 bits. A calibration must find the rest."""

    def __init__(self, kind, looks=1, share=0.9, floor_db=-25.0, seed=1, bits=16, water=None, width=WIDTH):
        """share: the ceiling over the type's largest number. water: the first return of each row, in
        columns from the left. width: the response's, pixels."""
        self.kind, self.looks, self.width = kind, looks, width
        self.parameter, level = KINDS[kind]
        self.ceiling = round(share * (2**bits - 1))
        random = numpy.random.default_rng(seed)
        shape = (ROWS, COLUMNS)
        seabed = _smooth(random.standard_normal(shape), 40.0).real
        seabed = 10 ** (seabed * LEVEL_DB / seabed.std() / 10)
        lit = numpy.ones(shape)
        for _ in range(14):  # shadows
            row, column = random.integers(0, ROWS - 40), random.integers(0, COLUMNS - 80)
            lit[row : row + 24, column : column + 60] = 0
        for _ in range(40):  # contacts that clip
            row, column = random.integers(0, ROWS - 8), random.integers(0, COLUMNS - 8)
            lit[row : row + 3, column : column + 5] = (1.6 / level) ** 2
        if water is not None:
            columns, first = numpy.arange(COLUMNS)[None, :], numpy.asarray(water)[:, None]
            lit[columns < first + 100] = 1  # no shadow hides where the seabed begins
            lit[columns < first] = 0
        noise = 10 ** (floor_db / 10)
        intensity = sum(
            numpy.abs(_field(random, shape, width) * (seabed * lit) ** 0.5
                      + _field(random, shape, width) * noise**0.5) ** 2 for _ in range(looks)) / looks
        amplitude = level * intensity**0.5
        if kind == "decibel":  # 80 dB from the lowest number to full scale
            self.parameter = 80.0 / self.ceiling
        stored = {
            "amplitude": lambda a: a,
            "intensity": lambda a: a**2,
            "gamma": lambda a: a ** (1 / self.parameter),
            "schlick": lambda a: a * self.parameter / (1 + (self.parameter - 1) * a),
            "decibel": lambda a: 1 + 20 * numpy.log10(numpy.maximum(a, 1e-9)) / 80,
        }[kind](amplitude)
        numbers = numpy.clip(numpy.round(self.ceiling * stored), 0, self.ceiling)
        self.numbers = numbers.astype(numpy.uint8 if bits == 8 else numpy.uint16)
        self.clipped = float(numpy.mean(numbers >= self.ceiling))
        self.floor_db = 10 * numpy.log10(noise / numpy.median(seabed + noise))


# The largest allowed standard errors, as shares of the value. The noise floor's is in dB. They are for speckle of
# WIDTH. Wider speckle has fewer grains, so errors grow with its width.
LIMITS = {"parameter": 0.05, "looks": 0.1, "noise_floor": 1.0, "response_along_track": 0.05,
          "response_range": 0.05}


def deviations(made, measured):
    """Returns for each estimate its error in standard errors, and its standard error over the limit."""
    found = {
        "looks": (measured["looks"], made.looks),
        "noise_floor": (measured["noise_floor"], made.floor_db),
        "response_along_track": (measured["response_along_track"], made.width),
        "response_range": (measured["response_range"], made.width),
    }
    if made.kind in ("gamma", "schlick", "decibel"):
        found["parameter"] = (measured["transfer"]["parameter"], made.parameter)
    result = {}
    for name, (estimate, truth) in found.items():
        assert "not_seen" not in estimate, (made.kind, made.looks, name, estimate)
        error = estimate["standard_error"]
        limit = LIMITS[name] * (1.0 if name == "noise_floor" else truth) * made.width / WIDTH
        result[name] = ((estimate["value"] - truth) / error, error / limit)
    return result
