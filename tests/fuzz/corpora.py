"""The fuzzers' first inputs, small and made here. make(kind, folder, source) fills a folder, and
words(kind, source) lists words that a mutation may put in. Some files are ones that a reader must
refuse and that a fuzzer would take long to think of."""

import json
import re
import struct
import sys
import zlib

import numpy


def _yaml(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.yaml"))}


def scenes(source):
    texts = _yaml(source / "tools" / "scenes")
    texts["recording.yaml"] = (
        b"sonject: 1\ninput: {path: line.xtf, channel: port, geometry: from_file}\n"
        b"sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: from_file}\n"
    )
    start = (b"sonject: 1\ninput: {uniform: {rows: 4, columns: 5}, geometry: {row_spacing: 1, "
             b"column_spacing: 1, first_slant_range: 40}}\n"
             b"sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10")
    sines = b", ".join([b"{amplitude: 1 mm, wavelength: 1 m}"] * 200)
    texts["sines.yaml"] = start + b", motion: {sway: [" + sines + b"]}}\n"
    texts["key.yaml"] = b"sonject: 1\n? [a]\n: b\n"
    return texts


def targets(source):
    return _yaml(source / "tools" / "targets")


def recordings(source):
    sys.path.insert(0, str(source / "tests" / "cli"))
    import recordings as writer

    samples = numpy.arange(24, dtype="<u2").reshape(3, 8)
    both = writer.xtf_bytes(samples, samples + 1)
    one = writer.file_header([writer.PORT], sample_bytes=1)
    for row in range(3):
        one += writer.ping([(0, samples[row].astype("u1"))], number=row)
    liar = bytearray(writer.file_header([writer.PORT]) + writer.ping([(0, samples[0])]))
    struct.pack_into("<I", liar, 1024 + 256 + 42, 1000)  # claims 1000 samples in a ping of 8
    return {"both": both, "port": one, "liar": bytes(liar), "degrees": writer.xtf_bytes(samples, samples, units=3),
            "empty": writer.file_header([writer.PORT])}


def jsf_recordings(source):
    sys.path.insert(0, str(source / "tests" / "cli"))
    import recordings as writer

    samples = numpy.arange(24, dtype="<u2").reshape(3, 8)
    pairs = numpy.arange(48, dtype="<i2").reshape(3, 8, 2)
    liar = bytearray(writer.jsf_ping(samples[0], 0))
    struct.pack_into("<H", liar, 16 + 114, 1000)  # claims 1000 samples in a ping of 8
    return {"both": writer.jsf_bytes(samples, samples + 1, heading=5.0), "pairs": writer.jsf_bytes(pairs, pairs),
            "weights": writer.jsf_bytes(samples, samples, subsystems=(20, 21), weights=(0, 3, -2)),
            "liar": bytes(liar), "empty": writer.jsf_bytes(samples, samples, empty=(0, 2), units=2)}


def arrays(_):
    def array(text, numbers, version=1):
        text = text.encode()
        length = struct.pack("<H" if version == 1 else "<I", len(text))
        return b"\x93NUMPY" + bytes([version, 0]) + length + text + numbers.tobytes()

    head = "{{'descr': '{}', 'fortran_order': {}, 'shape': ({}), }}"
    numbers = numpy.arange(6)
    return {
        **{kind[1:]: array(head.format(kind, False, "2, 3"), numbers.astype(kind))
           for kind in ("|u1", "<u2", ">u2", "<f4", "<c8")},
        "second": array(head.format("<f4", False, "2, 3"), numbers.astype("<f4"), 2),
        "fortran": array(head.format("<f4", True, "2, 3"), numbers.astype("<f4")),
        "flat": array(head.format("<f4", False, "6,"), numbers.astype("<f4")),
        "open": array("{'fortran_order': False, 'shape': (2, 3), 'descr': '", numbers),
    }


def _mat_element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def mat_array(name, kind, numbers, imaginary=None, kept=None):
    """Returns an array. kind: MATLAB's class, which gives the numbers' type. kept: bytes kept."""
    stored = {6: (9, "<f8"), 7: (7, "<f4"), 9: (2, "u1"), 10: (3, "<i2"), 11: (4, "<u2")}[kind]
    flags = struct.pack("<II", kind | (0x800 if imaginary is not None else 0), 0)
    body = _mat_element(6, flags) + _mat_element(5, struct.pack("<ii", *numbers.shape))
    body += _mat_element(1, name)
    for part in [numbers] + ([imaginary] if imaginary is not None else []):
        body += _mat_element(stored[0], part.astype(stored[1]).tobytes(order="F"))
    body = body[:kept]
    return struct.pack("<II", 14, len(body)) + body


MAT_HEAD = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"


def matlab(_):
    head = MAT_HEAD
    numbers = numpy.arange(6).reshape(2, 3)
    arrays = {kind: mat_array(b"swath", kind, numbers) for kind in (6, 7, 9, 10, 11)}
    packed = zlib.compress(arrays[7])
    return {
        **{f"class{kind}": head + array for kind, array in arrays.items()},
        "complex": head + mat_array(b"swath", 7, numbers, numbers),
        "two": head + arrays[7] + mat_array(b"other", 6, numbers),
        "compressed": head + struct.pack("<II", 15, len(packed)) + packed,
        "name": head + mat_array(b"n" * 100, 9, numbers),
        "liar": head + mat_array(b"swath", 9, numpy.ones((20, 30)), kept=100),
    }


VERTICES = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def stl(_):
    text = "solid a\n"
    binary = bytes(80) + struct.pack("<I", len(FACES))
    for face in FACES:
        corners = [VERTICES[i] for i in face]
        text += "facet normal 0 0 1\nouter loop\n"
        text += "".join("vertex {} {} {:e}\n".format(*corner) for corner in corners)
        text += "endloop\nendfacet\n"
        binary += struct.pack("<12fH", 0, 0, 1, *sum(corners, ()), 0)
    return {"text": (text + "endsolid a\n").encode(), "binary": binary}


def obj(_):
    vertices = "".join("v {} {} {}\n".format(*vertex) for vertex in VERTICES)
    faces = "".join("f {} {} {}\n".format(*(i + 1 for i in face)) for face in FACES)
    return {
        "plain": (vertices + faces).encode(),
        "rich": ("# a\nmtllib a.mtl\no a\nvt 0 1\nvn 0 0 1\n" + vertices
                 + "usemtl b\ns off\nf 1/1/1 2//1 3/1 4\nf -1 -2 \\\n-3\n").encode(),
    }


def ply(_):
    head = ("ply\nformat {} 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty double y\n"
            "property float z\nelement face 4\nproperty uchar flag\n"
            "property list uchar int vertex_indices\nend_header\n")
    text = "".join("{} {} {}\n".format(*vertex) for vertex in VERTICES)
    text += "".join("7 3 {} {} {}\n".format(*face) for face in FACES)
    files = {"text": (head.format("ascii") + text).encode()}
    for order, name in (("<", "binary_little_endian"), (">", "binary_big_endian")):
        body = b"".join(struct.pack(order + "fdf", *vertex) for vertex in VERTICES)
        body += b"".join(struct.pack(order + "BB3i", 7, 3, *face) for face in FACES)
        files[name] = head.format(name).encode() + body
    return files


def tables(_):
    return {
        "commas": b"depth,speed\n0,1500\n10,1490.5\n",
        "spaces": b"# a\ntime speed other\n0 1e3 2\n1\t-2 3 # b\n",
        "semicolons": b"depth;speed;note\r\n0;1500;x\r\n",
        "bodies": b"shape,length [m],width\nbox,0.6,40 cm\nsphere,,\n",
        "many": b"depth,speed\n" + b"0,1\n" * 101,
    }


def labels(_):
    """Returns labels of an image of 2 rows and 3 columns."""
    coco = {"images": [{"id": 1, "file_name": "a.npy", "width": 3, "height": 2}],
            "categories": [{"id": 1, "name": "highlight"}, {"id": 2, "name": "shadow"}],
            "annotations": [{"image_id": 1, "category_id": 1, "bbox": [0, 0, 1, 2]},
                            {"image_id": 1, "category_id": 2, "bbox": [1, 0, 2, 2]}]}
    box = b"<bndbox><xmin>1</xmin><ymin>1</ymin><xmax>3</xmax><ymax>2</ymax></bndbox>"
    return {
        "coco": json.dumps(coco).encode(),
        "plain": b"image,row,column,rows,columns,part\na.npy,0,0,1,1,highlight\na.npy,0,1,1,2,shadow\n",
        "own": b'image,class,box_row,box_column,box_rows,box_columns\n"a.npy","a, b",0,0,1,1\n',
        "quantiles": b"quantiles: [0.1, 0.5]\ncontacts: 12\nshadow_range: [1, 2 m]\n"
                     b"highlight_along: [20 cm, 1]\n",
        "yolo": b"0 0.5 0.5 0.2 0.2\n1 0.5 0.5 1 1\n",
        "voc": b"<annotation><filename>a.npy</filename><size><width>3</width><height>2</height></size>"
               b"<object><name>shadow</name>" + box + b"</object></annotation>",
    }


MAKERS = {"scene": scenes, "target": targets, "xtf": recordings, "jsf": jsf_recordings, "npy": arrays, "mat": matlab,
          "stl": stl, "obj": obj, "ply": ply, "table": tables, "labels": labels}
TEXTS = {"scene", "target", "npy", "stl", "obj", "ply", "table", "labels"}


def make(kind, folder, source):
    folder.mkdir(parents=True)
    for name, content in MAKERS[kind](source).items():
        (folder / name).write_bytes(content)


def words(kind, source):
    """Returns the corpus's words for a dictionary, none where the bytes are no text."""
    if kind not in TEXTS:
        return []
    contents = b"\n".join(MAKERS[kind](source).values())
    return sorted({word.decode() for word in re.findall(rb"[A-Za-z_]{2,30}", contents)})
