"""A synthetic aperture image from hydrophone time series by delay and sum.

    python3 delay_and_sum.py FOLDER

reads the series.npy and elements.json that ``sonject elements SCENE.yaml -o FOLDER`` wrote, and
writes image.npy. The code is written for readers, not for speed: every pixel uses every ping.
"""

import json
import pathlib
import sys

import numpy

FINE = 8  # samples for each of the series; linear interpolation between them errs by 0.1 %


def finer(series):
    """Returns the series at FINE times its sampling rate, by zeros about its spectrum."""
    count = series.shape[-1]
    spectrum = numpy.fft.fft(series)
    middle = (count + 1) // 2
    padded = numpy.zeros(series.shape[:-1] + (FINE * count,), complex)
    padded[..., :middle] = spectrum[..., :middle]
    padded[..., middle - count :] = spectrum[..., middle:]
    return FINE * numpy.fft.ifft(padded)


def pattern(length, sine, wavelength):
    """Returns the amplitude of a line transducer off abeam."""
    return numpy.sinc(length * sine / wavelength)


def delay_and_sum(
    series,
    *,
    transmitter_m,
    hydrophones_m,
    along_track_m,
    slant_range_m,
    sampling_rate_hz,
    first_time_s,
    sound_speed_mps,
    centre_frequency_hz,
    resolution_m,
    transmitter_length_m=0.0,
    hydrophone_length_m=0.0,
):
    """Returns complex pixels, rows (along_track_m) x columns (slant_range_m).

    series: complex baseband, range-compressed, [ping, hydrophone, sample]. transmitter_m: of each
    ping. hydrophones_m: of each ping and hydrophone. A point target of unit cross-section peaks at
    1: spreading and patterns are undone, and the weights of each pixel add up to one. Aspects of a
    sine up to wavelength / (4 resolution_m) count alike, so that a point is resolution_m wide.
    """
    wavelength = sound_speed_mps / centre_frequency_hz
    widest = wavelength / (4 * resolution_m)
    columns = numpy.asarray(slant_range_m, float)
    image = numpy.zeros((len(along_track_m), len(columns)), complex)
    weights = numpy.zeros(image.shape)
    for ping, hydrophone in numpy.ndindex(*series.shape[:2]):
        sent, heard = transmitter_m[ping], hydrophones_m[ping, hydrophone]
        aside = numpy.abs(along_track_m - 0.5 * (sent + heard))
        rows = numpy.flatnonzero(aside < columns[-1] * widest / numpy.sqrt(1 - widest**2) + 1e-9)
        if rows.size == 0:
            continue
        trace = finer(series[ping, hydrophone])
        x = numpy.asarray(along_track_m, float)[rows, None]
        there, back = numpy.hypot(x - sent, columns), numpy.hypot(x - heard, columns)
        sine_there, sine_back = (x - sent) / there, (x - heard) / back
        delay = (there + back) / sound_speed_mps
        sample = (delay - first_time_s) * sampling_rate_hz * FINE
        whole = numpy.clip(numpy.floor(sample).astype(int), 0, len(trace) - 2)
        part = numpy.where((sample >= 0) & (sample < len(trace) - 1), sample - whole, 0)
        value = trace[whole] * (1 - part) + trace[whole + 1] * part
        phase = 2 * numpy.pi * centre_frequency_hz * (delay - 2 * columns / sound_speed_mps)
        gain = pattern(transmitter_length_m, sine_there, wavelength) * pattern(
            hydrophone_length_m, sine_back, wavelength
        )
        # the share of the aperture, in sines, of a step along the track: r^2 / R^3
        share = columns**2 / (0.5 * (there + back)) ** 3
        share = numpy.where(numpy.abs(0.5 * (sine_there + sine_back)) <= widest, share, 0)
        image[rows] += share * there * back / gain * value * numpy.exp(-1j * phase)
        weights[rows] += share
    return image / weights


def read(folder):
    """Returns series, geometry (arguments of delay_and_sum) and image axes from a folder."""
    facts = json.loads((pathlib.Path(folder) / "elements.json").read_text(encoding="utf-8"))
    if facts["form"] != "baseband" or facts["pulse"] != "compressed":
        raise SystemExit("compressed pulses in complex baseband are wanted")
    array = facts["array"]
    origins = array["first_ping_m"] + array["ping_spacing_m"] * numpy.arange(array["pings"])
    offsets = array["first_hydrophone_m"] + array["hydrophone_spacing_m"] * numpy.arange(
        array["hydrophones"]
    )
    return numpy.load(pathlib.Path(folder) / facts["series"]), {
        "transmitter_m": origins + array["transmitter_offset_m"],
        "hydrophones_m": origins[:, None] + offsets,
        "sampling_rate_hz": facts["sampling_rate_hz"],
        "first_time_s": facts["first_time_s"],
        "sound_speed_mps": facts["sound_speed_mps"],
        "centre_frequency_hz": facts["centre_frequency_hz"],
        "resolution_m": facts["along_track_resolution_m"],
        "transmitter_length_m": array["transmitter_length_m"],
        "hydrophone_length_m": array["hydrophone_length_m"],
    }, facts["image"]


def main():
    folder = sys.argv[1]
    series, geometry, axes = read(folder)
    along_track = axes["first_along_track_m"] + axes["row_spacing_m"] * numpy.arange(axes["rows"])
    slant_range = axes["first_slant_range_m"] + axes["column_spacing_m"] * numpy.arange(
        axes["columns"]
    )
    image = delay_and_sum(
        series, along_track_m=along_track, slant_range_m=slant_range, **geometry
    )
    numpy.save(pathlib.Path(folder) / "image.npy", image.astype(numpy.complex64))


if __name__ == "__main__":
    main()
