"""Tests a campaign of 10,000 draws over all shapes with careless ranges. It never stops, and reports what it
drew anew and why. Takes two minutes. SONJECT_CARELESS_IMAGES sets another number of draws."""

import json
import os
import subprocess

import numpy

import images
from conftest import COMMAND, page_data
from test_campaign import SCENE

IMAGES = int(os.environ.get("SONJECT_CARELESS_IMAGES", "10000"))
SIZES = {"plane": "length width", "disc": "diameter", "sphere": "diameter", "ellipsoid": "length width height",
         "cylinder": "length diameter", "capsule": "length diameter", "box": "length width height",
         "wedge": "length width height front_height", "cone": "diameter height",
         "truncated_cone": "diameter height top_diameter", "torus": "diameter height"}

CAMPAIGN = f"""\
sonject_campaign: 1
scene: scene.yaml
images: {IMAGES}
seed: 7
chip: {{rows: 48, columns: 48, spread: 0.9}}
swaths: [{{path: swath.png}}]
outputs: []
draw:
  objects[].heading: {{uniform: [0 deg, 360 deg]}}
  objects[].pitch: {{uniform: [-90 deg, 90 deg]}}
  objects[].roll: {{uniform: [-90 deg, 90 deg]}}
  objects[].burial: {{uniform: [-1 m, 2 m]}}
targets:
"""
TARGET = "  - {{class: {shape}, object: {{shape: {shape}}}, draw: {{{sizes}}}}}\n"


def test_a_careless_campaign_never_stops(tmp_path):
    amplitudes = numpy.random.default_rng(1).rayleigh(30, (300, 300)).clip(1, 255)
    (tmp_path / "swath.png").write_bytes(images.png_bytes(amplitudes))
    (tmp_path / "scene.yaml").write_text(SCENE)
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN + "".join(
        TARGET.format(shape=shape, sizes=", ".join(f"{key}: {{log_uniform: [0.005 m, 3 m]}}" for key in keys.split()))
        for shape, keys in SIZES.items()))
    subprocess.run([COMMAND, "campaign", "campaign.yaml", "-o", "out", "--quiet"], check=True, cwd=tmp_path)
    records = [json.loads(path.read_text()) for path in (tmp_path / "out").glob("*/records/*.json")]
    anew = [record["drawn_anew"] for record in records if "drawn_anew" in record]
    assert len(records) == IMAGES
    print(f"{len(anew)} of {IMAGES} images drawn anew, {max(each['times'] for each in anew)} times at most")
    # a torus has a hole in half of the draws, and objects above 1.2 m are larger than the chip
    assert 0.2 * IMAGES < len(anew) < 0.6 * IMAGES
    assert page_data(tmp_path / "out")["drawn_anew"] == len(anew)
