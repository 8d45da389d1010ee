"""The scene and the campaign of images of 256 x 256 pixels that are timed."""

SCENE = """\
sonject: 1
input:
  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 43.6 m}
  transfer: {kind: schlick, parameter: 3}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m, resolution: 4 cm}
"""

# A sidescan at high frequency, whose glints take most rays; chips of it are 96 x 160 pixels.
SIDESCAN = """\
sonject: 1
input:
  geometry: {row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 15 m}
  transfer: {kind: schlick, parameter: 3}
sonar: {kind: real, array: {length: 0.8 m}, frequency: 455 kHz, bandwidth: 15 kHz, altitude: 6 m}
"""

CAMPAIGN = """\
sonject_campaign: 1
scene: %s
images: %d
chip: {rows: %d, columns: %d}
empty: 0.1
swaths: %s
draw:
  seabed.lambert: {uniform: [-30 dB, -24 dB]}
  objects[].heading: {uniform: [0 deg, 360 deg]}
  objects[].burial: {uniform: [0 cm, 10 cm]}
targets:
  - {class: capsule, object: {shape: capsule, length: 1.8 m, diameter: 0.4 m}}
  - {class: cylinder, object: {shape: cylinder, length: 1.2 m, diameter: 0.3 m}}
  - {class: ball, object: {shape: sphere, diameter: 0.5 m}}
"""

SWATHS = [f"swath{seed}.png" for seed in range(4)]


def swath_arguments(seed):
    """Of the command, to make one of the swaths."""
    return ["seabed", "-o", SWATHS[seed], "--rows", "472", "--columns", "512", "--seed", str(seed)]
