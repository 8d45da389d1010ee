/* Tests wrong scene files. Each message tells the place, the key, the mistake, and what to do. */
#include "claims.h"
#include "scene_folder.h"

#define SONAR_WITH(keys) "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10, " keys "}\n"
#define OBJECT           BASE "objects:\n  - shape: "

#define MATERIAL OBJECT "sphere\n    diameter: 1\n    material: " /* the value is on line 7 */
#define KNOWN_MATERIALS                                                                            \
    "steel, concrete, rubber, wood, rock, gravel, coarse sand, medium sand, fine sand, silt, clay"

TEST(test_unknown_keys)
{
    static const struct refusal wrong[] = {
        {BASE "medum: {}\n", ":4:1: medum: unknown key; did you mean 'medium'?"},
        {BASE "medium:\n  salinity: 35\n",
         ":5:3: medium.salinity: unknown key; known here are sound_speed, reference_sound_speed, "
         "absorption, layers, profile"},
        {BASE
         "objects:\n  - {shape: sphere, diameter: 1}\n  - {shape: plane, lenght: 1, width: 1}\n",
         ":6:20: objects[1].lenght: unknown key; did you mean 'length'?"},
        {OBJECT "sphere\n    \xC3\xA9tat: 1 m\n    diameter: 1 m\n",
         ":6:5: objects[0].\xC3\xA9tat: unknown key; known here are target, name, class, shape, "
         "length, width, diameter, height, top_diameter, front_height, nose_end, tail_end, mesh, "
         "position, heading, pitch, roll, burial, level, material, fouling, parts"},
    };
    expect_all_refused(wrong, COUNT(wrong));
}

TEST(test_missing_keys)
{
    static const struct refusal wrong[] = {
        {INPUT SONAR, ":1:1: sonject: missing; add it (version of the format, 1)"},
        {START, ":1:1: input: missing; add it (where the image comes from: path, uniform or "
                "synthetic, and geometry)\n"
                ":1:1: sonar: missing; add it (the sonar: frequency, bandwidth and altitude)"},
        {START INPUT "sonar:\n", ":3:7: sonar.frequency: missing; add it (centre frequency)\n"
                                 ":3:7: sonar.bandwidth: missing; add it (sets the range "
                                 "resolution, c / (2 bandwidth))\n"
                                 ":3:7: sonar.altitude: missing; add it (height of the track over "
                                 "the mean seabed; from_file, or first_return of the calibration)"},
        {START "input:\n  uniform: {rows: 1, columns: 1}\n  geometry: {row_spacing: {speed: 2}, "
               "column_spacing: 1, first_slant_range: 40}\n" SONAR,
         ":4:27: input.geometry.row_spacing.ping_rate: missing; add it (pings per second; each "
         "ping is one row)"},
        {START "input:\n  uniform: {rows: 1, columns: 1}\n  geometry: {row_spacing: {speed: 2, "
               "ping_rate: 0}, column_spacing: 1, first_slant_range: 40}\n" SONAR,
         ":4:49: input.geometry.row_spacing.ping_rate: must be above 0 Hz, not 0"},
        {OBJECT "capsule\n    diameter: 1\n",
         ":5:5: objects[0].length: missing; a capsule needs it"},
        {OBJECT "ellipsoid\n    length: 1\n    width: 1\n",
         ":5:5: objects[0].height: missing; an ellipsoid needs it"},
        {BASE "objects: [{}]\n",
         ":4:11: objects[0]: none of shape, parts and target is there; give one"},
    };
    expect_all_refused(wrong, COUNT(wrong));
}

TEST(test_wrong_values)
{
    static const struct refusal wrong[] = {
        {BASE "medium:\n  sound_speed: 1500 knots\n",
         ":5:16: medium.sound_speed: unit 'knots' is not one of m/s, km/s"},
        {BASE "medium: {sound_speed: 1.5 Km/s}\n",
         ":4:23: medium.sound_speed: unit 'Km/s' is not one of m/s, km/s"},
        {BASE "seabed: {lambert: 4000 dB}\n", ":4:19: seabed.lambert: '4000 dB' is too large"},
        {BASE "injection: {rays: 3 m}\n",
         ":4:19: injection.rays: 'm' follows the number, but this has no unit"},
        {BASE "medium: {sound_speed: fast}\n",
         ":4:23: medium.sound_speed: 'fast' is not a number with a unit of m/s, km/s"},
        {BASE "medium: {sound_speed: 15}\n",
         ":4:23: medium.sound_speed: must be 100...10000 m/s, not 15"},
        {BASE "medium: {sound_speed: .nan}\n",
         ":4:23: medium.sound_speed: '.nan' is not a number with a unit of m/s, km/s"},
        {BASE "medium: {sound_speed: .inf}\n",
         ":4:23: medium.sound_speed: must be 100...10000 m/s, not inf"},
        {BASE "medium: {sound_speed: 1e999}\n", ":4:23: medium.sound_speed: '1e999' is too large"},
        {BASE "medium: {sound_speed: [1500]}\n",
         ":4:23: medium.sound_speed: must be a single value, not a list"},
        {BASE "medium: {sound_speed: {a: 1}}\n",
         ":4:23: medium.sound_speed: must be a single value, not a section"},
        {BASE "medium: {sound_speed: }\n",
         ":4:23: medium.sound_speed: has no value; write one or remove the key"},
        {BASE "medium: 1500 m/s\n",
         ":4:9: medium: must be a section of 'key: value' lines, not a single value"},
        {BASE "medium: [1500 m/s]\n",
         ":4:9: medium: must be a section of 'key: value' lines, not a list"},
        {BASE "patch: {rows: 1, columns: 2.5}\n",
         ":4:27: patch.columns: '2.5' is not a whole number from 1 to 1099511627776"},
        {BASE "patch: {rows: 1, columns: 1099511627777}\n",
         ":4:27: patch.columns: must be 1...1099511627776, not 1099511627777"},
        {BASE "patch: {rows: 0, columns: 1}\n",
         ":4:15: patch.rows: must be 1...1099511627776, not 0"},
        {BASE "injection: {seed: 18446744073709551616}\n",
         ":4:19: injection.seed: '18446744073709551616' is not a whole number from 0 to "
         "18446744073709551615"},
        {BASE "injection: {mode: compsite}\n",
         ":4:19: injection.mode: 'compsite' is not one of composite, resynthesise; did you mean "
         "'composite'?"},
        {BASE "injection: {noise_floor: 3 dB}\n", ":4:26: injection.noise_floor: must be below 0 "
                                                  "dB (the seabed's own level) or estimate, not "
                                                  "3"},
        {BASE "seabed: {lambert: 3 dB}\n",
         ":4:19: seabed.lambert: must be above 0 and at most 1/pi (-4.97 dB), or the seabed "
         "returns more than it receives, not 1.99526"},
        {START INPUT SONAR_WITH("aperture: -3 deg"),
         ":3:68: sonar.aperture: must be 0...90 deg, auto or none, not -3"},
        {START INPUT SONAR_WITH("kind: real"),
         ":3:8: sonar.array: missing; a real aperture needs its length"},
        {START INPUT SONAR_WITH("array: {length: 1 m}"),
         ":3:65: sonar.array: belongs to a real aperture; set kind: real"},
        {START INPUT SONAR_WITH("kind: real, aperture: none, array: {length: 1 m}"),
         ":3:80: sonar.aperture: belongs to a synthetic aperture; a real one has that of its "
         "array"},
        {"sonject: 2\n" INPUT SONAR,
         ":1:10: sonject: must be 1, the version of the format that is read here"},
        {BASE "objects: {shape: sphere}\n",
         ":4:10: objects: must be a list; start each object with '- '"},
        {OBJECT "cube\n",
         ":5:12: objects[0].shape: 'cube' is not one of " SHAPE_WORDS "; did you mean 'cone'?"},
        {OBJECT "cylinder\n    diameter: 1\n    length: 2\n    nose_end: round\n",
         ":8:15: objects[0].nose_end: 'round' is not one of flat, open, spherical, {depth: ...}"},
        {OBJECT "cylinder\n    diameter: 1\n    length: 2\n    tail_end: {depth: 0}\n",
         ":8:23: objects[0].tail_end.depth: must be above 0 (write 'spherical' for a half sphere, "
         "'flat' for none), not 0"},
        {OBJECT "cylinder\n    diameter: 1\n    length: 2\n    nose_end: {depth: 0.6}\n",
         ":8:23: objects[0].nose_end.depth: must be 0...0.5 m (half the diameter), not 0.6"},
        {OBJECT "cylinder\n    diameter: 1\n    length: 0.9\n    nose_end: spherical\n    "
                "tail_end: spherical\n",
         ":7:13: objects[0].length: of a cylinder includes its spherical ends and must be at "
         "least their 1 m, not 0.9 m"},
        {OBJECT "torus\n    diameter: 1\n    height: 0.5\n",
         ":6:15: objects[0].diameter: of a torus is that of its outline and must be above twice "
         "its height, 1 m, or there is no hole; it is 1 m"},
        {OBJECT "sphere\n    diameter: 1\n    burial: {fraction: 0.5, proud: 0.5}\n",
         ":7:13: objects[0].burial: more than one of fraction and proud is there; give one"},
        {OBJECT "sphere\n    diameter: 1 m\n    material: {lambert: 0.3}\n",
         ":7:25: objects[0].material.lambert: must be 0...0.2578 (reflection^2 / pi), or the "
         "surface returns more than it receives; it is 0.3"},
        {OBJECT "sphere\n    diameter: 1\n    class: \"a\\tb\"\n",
         ":7:12: objects[0].class: must be UTF-8 text without control characters"},
        {OBJECT "sphere\n    diameter: 1\n    name: "
                "0123456789012345678901234567890123456789012345678901234567890123\n",
         ":7:11: objects[0].name: longer than 63 bytes; shorten it"},
        {"- a\n", ":1:1: must be a section of 'key: value' lines, not a list"},
    };
    expect_all_refused(wrong, COUNT(wrong));
}

TEST(test_keys_that_exclude_or_need_each_other)
{
    static const char geometry[] =
        ", geometry: {row_spacing: 1, column_spacing: 1, first_slant_range: 40}}\n";
    static const struct refusal inputs[] = {
        {"input: {path: a.tif, uniform: {rows: 1, columns: 1}",
         ":2:8: input: more than one of path, uniform and synthetic is there; give one"},
        {"input: {complex: true",
         ":2:8: input: none of path, uniform and synthetic is there; give one"},
        {"input: {uniform: {rows: 1, columns: 1}, complex: true",
         ":2:50: input.complex: belongs to an image file (path), not to uniform; remove it"},
        {"input: {synthetic: {rows: 1, columns: 1}, transfer: {kind: amplitude}",
         ":2:53: input.transfer: belongs to an image file (path), not to synthetic; remove it"},
        {"input: {path: a.tif, complex: yes",
         ":2:31: input.complex: 'yes' is neither true nor false"},
        {"input: {path: \"\"", ":2:15: input.path: must be a file name without control characters"},
        {"input: {path: a.tif, transfer: {kind: gamma}",
         ":2:32: input.transfer.parameter: missing; this kind of transfer needs it"},
        {"input: {path: a.tif, transfer: {kind: intensity, parameter: 1}",
         ":2:61: input.transfer.parameter: this kind of transfer has none; remove it"},
        {"input: {path: a.tif, transfer: {kind: gamma, parameter: 1, offset: 1}",
         ":2:68: input.transfer.offset: only the decibel kind has one; remove it"},
        {"input: {path: a.tif, transfer: {kind: schlick, parameter: 0.5}",
         ":2:59: input.transfer.parameter: must be 1...1e+06, not 0.5"},
        {"input: {path: a.tif, transfer: {kind: gamma, parameter: 0}",
         ":2:57: input.transfer.parameter: must be 0.01...100 (an exponent), not 0"},
        {"input: {path: a.tif, transfer: {kind: decibel, parameter: 0, offset: 1001}",
         ":2:59: input.transfer.parameter: must be 1e-06...1000 dB per unit, not 0\n"
         ":2:70: input.transfer.offset: must be -1000...1000 dB, not 1001"},
        {"input: {uniform: {rows: 65536, columns: 32769}",
         ":2:25: input.uniform.rows: times columns must be at most 2^31 pixels, not 65536 x 32769"},
    };
    static const struct refusal wrong[] = {
        {BASE "seabed: {map: coherent}\n", ":4:15: seabed.map: coherent needs complex pixels; set "
                                           "complex: true in input if they are"},
        {OBJECT "sphere\n    diameter: 1\n    width: 1\n",
         ":7:12: objects[0].width: a sphere has none; remove it"},
        {OBJECT "wedge\n    length: 1\n    width: 1\n    height: 0.5\n    front_height: 0.51\n",
         ":9:19: objects[0].front_height: must be 0...0.5 m (the height), not 0.51"},
        {OBJECT "capsule\n    diameter: 1\n    length: 0.5\n",
         ":7:13: objects[0].length: of a capsule includes its round ends and must be at least its "
         "diameter, 1 m, not 0.5 m"},
        {OBJECT "sphere\n    diameter: 1\n    position: {row: 1}\n",
         ":7:15: objects[0].position: needs along_track and slant_range, or row and column; give "
         "one of these"},
        {OBJECT "sphere\n    diameter: 1\n    position: {row: 1, slant_range: 40}\n",
         ":7:15: objects[0].position: needs along_track and slant_range, or row and column; give "
         "one of these"},
        {OBJECT "sphere\n    diameter: 1\n    position: {row: 2e12, column: 2e12}\n",
         ":7:21: objects[0].position.row: must be -1...1.09951e+12, not 2e+12\n"
         ":7:35: objects[0].position.column: must be -1...1.09951e+12, not 2e+12"},
        {OBJECT "sphere\n    diameter: 1\n    position: middle\n",
         ":7:15: objects[0].position: 'middle' is not one of centre, {along_track: ...}, "
         "{slant_range: ...}, {row: ...}, {column: ...}"},
        {START INPUT "sonar: {frequency: 10e3, bandwidth: 20e3, altitude: 10}\n",
         ":3:37: sonar.bandwidth: must be below twice the frequency, 20000 Hz, not 20000 Hz"},
        {START INPUT "sonar: {frequency: 10e3, bandwidth: 1e3, altitude: 10, response: {taylor: "
                     "{sidelobes: 0 dB, terms: 1}}}\n",
         ":3:87: sonar.response.taylor.sidelobes: must be 1...120 dB, not 0\n"
         ":3:100: sonar.response.taylor.terms: must be 2...16, not 1"},
        {MATERIAL "steel\n    fouling: {albedo: 12 dB, relief: 3 cm}\n",
         ":8:23: objects[0].fouling.albedo: must be 0...10 dB, not 12\n"
         ":8:38: objects[0].fouling.relief: must be at most half of relief_length, 0.05 m, but is "
         "0.03 m"},
        {START INPUT "sonar: {frequency: 10e3, bandwidth: 1e3, altitude: 10}\n"
                     "seabed: {lambert: -20 dB, sediment: {grain_size: 10}}\n",
         ":4:50: seabed.sediment.grain_size: must be -1...9, not 10"},
        {START INPUT "sonar: {frequency: 10e3, bandwidth: 1e3, altitude: 10}\n"
                     "seabed: {lambert: -20 dB, sediment: silt}\n",
         ":4:19: seabed.lambert: the sediment sets it, too; remove one of the two"},
        {MATERIAL "stele\n", ":7:15: objects[0].material: 'stele' is not one of " KNOWN_MATERIALS
                             "; did you mean 'steel'?"},
        {MATERIAL "{reflection: 0.5, lambert: 0.05, glossy: {albedo: 0.2}}\n",
         ":7:65: objects[0].material.glossy.albedo: must be 0...0.09292 (reflection^2 - pi "
         "lambert), or the surface returns more than it receives; it is 0.2"},
        {MATERIAL "{fluid: {density: 2}}\n",
         ":7:23: objects[0].material.fluid.speed: missing; a fluid needs it (ratio to the "
         "water's)"},
        {MATERIAL "{reflection: 0.9, fluid: {density: 2, speed: 3}}\n",
         ":7:28: objects[0].material.reflection: fluid sets the reflection at every angle; remove "
         "one of the two"},
        {BASE "seabed: {forward: medium snad}\n",
         ":4:19: seabed.forward: 'medium snad' is not one of " KNOWN_MATERIALS
         "; did you mean 'medium sand'?"},
        {BASE "seabed: {forward: {lambert: 0 dB}}\n",
         ":4:29: seabed.forward.lambert: must be 0...0.3183 (1 / pi), or the surface returns more "
         "than it receives; it is 1"},
        {BASE "seabed: {lambert: 0.02, forward: {reflection: 0.2}}\n",
         ":4:34: seabed.forward.lambert: must be 0...0.01273 (reflection^2 / pi), or the surface "
         "returns more than it receives; it is the seabed's own, 0.02"},
        {BASE "injection: {interactions: 0}\n",
         ":4:27: injection.interactions: must be 1...8 surfaces, not 0"},
        {BASE "injection: {estimator: brute_force}\n",
         ":4:24: injection.estimator: brute_force traces the whole patch and needs mode: "
         "resynthesise"},
        {BASE "injection: {estimator: brute_force, mode: resynthesise}\n",
         ":4:24: injection.estimator: brute_force needs a source that rays can hit; set transducer "
         "in sonar"},
        {BASE "surface: {depth: 20, reflection: -0.5, lambert: 0.05, glossy: {albedo: 0.1}}\n",
         ":4:72: surface.glossy.albedo: must be 0...0.09292 (reflection^2 - pi lambert), or the "
         "surface returns more than it receives; it is 0.1"},
        {BASE "elements: {first_time: 60 ms, last_time: 50 ms}\n",
         ":4:42: elements.last_time: must not be before first_time, 0.06 s, but is 0.05 s"},
        {BASE "elements: {sampling_rate: 20 kHz}\n",
         ":4:27: elements.sampling_rate: must be at least 30000 Hz for the sonar's band, not 20000 "
         "Hz"},
        {BASE "elements: {form: passband, sampling_rate: 229 kHz}\n",
         ":4:43: elements.sampling_rate: must be at least 230000 Hz for the sonar's band, not "
         "229000 Hz"},
    };
    for (size_t i = 0; i < COUNT(inputs); i++) {
        char text[1000];
        snprintf(text, sizeof text, "%s%s%s%s", START, inputs[i].text, geometry, SONAR);
        expect_scene_refused(text, inputs[i].message);
    }
    expect_all_refused(wrong, COUNT(wrong));
}

TEST(test_yaml_that_is_not_wanted)
{
    static const struct refusal wrong[] = {
        {"", ":1:1: there is nothing in it"},
        {"---\n", ":2:1: there is nothing in it; start with 'sonject: 1'"},
        {BASE "---\nsonject: 1\n", ":4:1: a second document starts here; keep one in a file"},
        {BASE "medium: {}\nmedium: {}\n", ":5:1: medium: given twice, first on line 4; remove one"},
        {BASE "medium: &m {sound_speed: 1500}\n",
         ":4:9: medium: anchors and tags (&name, !name) are not supported; remove it"},
        {BASE "medium: *m\n",
         ":4:9: medium: aliases (*name) are not supported; write the value out"},
        {BASE "medium: !!map {}\n",
         ":4:9: medium: anchors and tags (&name, !name) are not supported; remove it"},
        {BASE "medium: {sound_speed: !!float 1500}\n",
         ":4:23: medium.sound_speed: anchors and tags (&name, !name) are not supported; remove it"},
        {BASE "objects: !!seq []\n",
         ":4:10: objects: anchors and tags (&name, !name) are not supported; remove it"},
        {BASE "[a]: 1\n", ":4:1: keys must be plain words; write 'key: value'"},
        {BASE "&k medium: {}\n", ":4:1: keys must be plain words; write 'key: value'"},
        {BASE "medium: {sound_speed: \"15\\000\"}\n",
         ":4:23: medium.sound_speed: contains a character 0; remove it"},
        {BASE "\"med\\0ium\": 1\n", ":4:1: the key contains a character 0; remove it"},
        {BASE "medium: {sound_speed: 1500\n",
         ":5:1: medium: not valid YAML (while parsing a flow mapping: did not find "
         "expected ',' or '}'); check indentation, colons, quotes and brackets"},
        {BASE "medium:\n\tsound_speed: 1\n",
         ":5:1: medium: not valid YAML (while scanning for the next token: found character that "
         "cannot start any token); check indentation, colons, quotes and brackets"},
        {BASE "medium: {sound_speed: \xFF}\n",
         ":4:23: not UTF-8 text (invalid leading UTF-8 octet); save the file as UTF-8"},
        {START "# \xC3\xA9\xE2\x82 broken\n",
         ":2:5: not UTF-8 text (invalid trailing UTF-8 octet); save the file as UTF-8"},
    };
    expect_all_refused(wrong, COUNT(wrong));
}

TEST(test_overrides_that_are_wrong)
{
    static const struct {
        const char *override;
        const char *message; /* the whole message */
    } wrong[] = {
        {"sonar.altitude", "--set sonar.altitude: has no '='; write key.path=value"},
        {"sonar.altitude=", "--set sonar.altitude: has no value; write key.path=value"},
        {"=3", "--set : not a key path; write it as 'objects[0].heading'"},
        {"sonar..altitude=3", "--set sonar..altitude: not a key path; write it as "
                              "'objects[0].heading'"},
        {"objects[0]heading=3", "--set objects[0]heading: not a key path; write it as "
                                "'objects[0].heading'"},
        {"objects[0=3", "--set objects[0: not a key path; ']' is missing"},
        {"objects[-1].x=3", "--set objects[-1].x: not a key path; an index must be a whole number "
                            "from 0"},
        {"objects[5].x=3", "--set objects[5].x: objects has 1 entries, counted from 0; [1] would "
                           "add one"},
        {"objects.x=3", "--set objects.x: objects is a list in the file, not a section; give the "
                        "whole of it"},
        {"sonar[0]=3", "--set sonar[0]: sonar is a section in the file, not a list; give the whole "
                       "of it"},
        {"sonar.altitude.x=3", "--set sonar.altitude.x: sonar.altitude is a value in the file, not "
                               "a section; give the whole of it"},
        {"a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t.u.v.w.x.y=1",
         "--set a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t.u.v.w.x.y: nested too deeply; no key of a "
         "scene is"},
        {"sonar.altitud=3", "--set sonar.altitud: unknown key; did you mean 'altitude'?"},
        {"sonar.altitude=3 kg", "--set sonar.altitude: unit 'kg' is not one of m, km, cm, mm"},
        {"sonar={altitude: 3}",
         "--set sonar: sonar.frequency: missing; add it (centre frequency)\n"
         "--set sonar: sonar.bandwidth: missing; add it (sets the range resolution, c / (2 "
         "bandwidth))"},
        {"medium={sound_speed: *a}", "--set medium: medium.sound_speed: aliases (*name) are not "
                                     "supported; write the value out"},
        {"medium={sound_speed: 1500", "--set medium: not valid YAML (while "
                                      "parsing a flow mapping: did not find expected ',' or '}'); "
                                      "check indentation, colons, quotes and brackets"},
        {"objects=[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]"
         "]",
         "--set objects: objects[0][0][0][0][0][0][0][0][0][0][0][0][0][0][0][0][0][0][0][0][0][0]"
         "[0][0][0][0][0][0][0][0][0][0]: nested too deeply; no scene needs this many levels"},
        {"input.path=\xFF", "--set input.path: not UTF-8 text on one line"},
        {"objects[0].name=a\nb", "--set objects[0].name: not UTF-8 text on one line"},
    };
    const char text[] = BASE "objects: [{shape: sphere, diameter: 1}]\n";
    write_scene(text, strlen(text));
    for (size_t i = 0; i < COUNT(wrong); i++) {
        if (read_scene(&wrong[i].override, 1) != SONJECT_ERROR_INPUT)
            fail_msg("%s was taken", wrong[i].override);
        assert_string_equal(folder->report.message, wrong[i].message);
    }
}

TEST(test_a_missing_file_is_named)
{
    struct report report = {.host = NULL};
    struct scene scene;
    scene_init(&scene);
    assert_int_equal(read_scene_file(&report, "/tmp/absent-scene.yaml", NULL, 0, &scene),
                     SONJECT_ERROR_INPUT);
    assert_string_equal(report.message,
                        "/tmp/absent-scene.yaml: there is no such scene file; check its name");
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
