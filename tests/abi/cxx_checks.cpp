/* What sonject.hpp promises beyond the C interface. Prints "all right", or what is not. */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <sonject.hpp>

static int failures;

static void expect(bool is_good, const char *what)
{
    if (!is_good)
        std::fprintf(stderr, "not so: %s\n", what);
    failures += !is_good;
}

static sonject::scene scene_with_ball(const sonject::context &context)
{
    sonject::scene scene(context);
    auto geometry = sonject::defaults<sonject_geometry_params>();
    geometry.first_slant_range_m = 30.0;
    scene.set(geometry);
    auto ball = sonject::defaults<sonject_object_params>();
    ball.shape = SONJECT_SHAPE_SPHERE;
    ball.diameter_m = 0.3;
    ball.material = sonject::material("steel");
    expect(scene.add(ball) == 0 && scene.object_count() == 1, "objects are counted");
    try {
        scene.add_target("there/is/none.yaml", ball);
        expect(false, "missing files of targets throw");
    } catch (const sonject::error &error) {
        expect(error.status() == SONJECT_ERROR_INPUT && scene.object_count() == 1,
               "and leave the scene");
    }
    return scene;
}

static void check_errors(const sonject::context &context)
{
    sonject::scene scene(context);
    auto sonar = sonject::defaults<sonject_sonar_params>();
    sonar.altitude_m = -1.0;
    try {
        scene.set(sonar);
        expect(false, "bad values throw");
    } catch (const sonject::error &error) {
        expect(error.status() == SONJECT_ERROR_INPUT, "the status is in the exception");
        expect(std::string(error.what()).find("altitude") != std::string::npos,
               "and the library's message");
    }
    try {
        sonject::material("unobtainium");
        expect(false, "unknown materials throw");
    } catch (const sonject::error &) {
    }
    try {
        const std::vector<double> bottoms = {0.0, 5.0}, speeds = {1500.0};
        scene.set_water_layers(bottoms, speeds);
        expect(false, "sizes that differ throw");
    } catch (const sonject::error &) {
    }
    try {
        sonject::scene missing(context, "there/is/none.yaml");
        expect(false, "missing scene files throw");
    } catch (const sonject::error &) {
    }
}

static void check_results(const sonject::context &context)
{
    const std::vector<float> seabed(64 * 80, 0.1f);
    sonject::scene scene = scene_with_ball(context);
    const sonject::scene moved = std::move(scene);
    sonject::result first = sonject::inject(moved, {seabed.data(), 64, 80});
    const sonject::result result = std::move(first);
    expect(result.rows() == 64 && result.columns() == 80 && !result.is_complex(), "sizes");
    const std::vector<float> image = result.image();
    expect(image.size() == seabed.size() && image != seabed, "the image has changed");
    std::vector<float> energy(64 * 80);
    result.layer<float>(SONJECT_LAYER_ENERGY, energy);
    expect(energy == result.energy(), "both ways to a layer");
    expect(result.object_count() == 1 && result.object(0).is_visible == 1, "the truth");
    expect(result.statistics().rays > 0, "the statistics");
    std::vector<float> small(3);
    try {
        result.layer<float>(SONJECT_LAYER_ENERGY, small);
        expect(false, "wrong sizes throw");
    } catch (const sonject::error &) {
    }
}

/* Tables of samples whose numbers differ, and what they do to a scene. */
static void check_tables(const sonject::context &context)
{
    const std::vector<double> places = {-0.2, -0.1, 0.0, 0.1, 0.2}, few = {1.0};
    const std::vector<double> samples = {0.0, 0.5, 1.0, 0.5, 0.0};
    sonject::scene scene = scene_with_ball(context);
    scene.set_pulse_table(SONJECT_PULSE_AXIS_RANGE, places, samples, samples);
    scene.set(sonject::defaults<sonject_pulse_params>());
    scene.set_cross_range_table(places, samples);
    scene.set_cross_range_table(sonject::span<const double>(), sonject::span<const double>());
    scene.set_motion_table(places, samples);
    auto motion = sonject::defaults<sonject_motion_params>();
    motion.random_rms_m = 1e-4;
    scene.set(motion);
    int refused = 0;
    for (int number = 0; number < 4; number++)
        try {
            if (number == 0)
                scene.set_pulse_table(SONJECT_PULSE_AXIS_RANGE, places, few);
            else if (number == 1)
                scene.set_pulse_table(SONJECT_PULSE_AXIS_RANGE, places, samples, few);
            else if (number == 2)
                scene.set_cross_range_table(few, samples);
            else
                scene.set_motion_table(places, few);
        } catch (const sonject::error &error) {
            refused += error.status() == SONJECT_ERROR_ARGUMENT;
        }
    expect(refused == 4, "tables of other sizes throw");
}

static void check_elements(const sonject::context &context)
{
    const std::vector<float> seabed(32 * 40, 0.1f);
    sonject::scene scene = scene_with_ball(context);
    auto elements = sonject::defaults<sonject_elements_params>();
    elements.hydrophones = 2;
    scene.set(elements);
    const sonject_element_layout layout = scene.describe_elements(32, 40);
    const std::vector<float> series = sonject::element_series(scene, {seabed.data(), 32, 40});
    expect(series.size() == 2 * 2 * layout.elements.pings * layout.samples, "series fill a layout");
    float loudest = 0.0f;
    for (float sample : series)
        loudest = std::max(loudest, sample);
    expect(loudest > 0.0f, "the ball is heard");
}

static void check_measures(const sonject::context &context)
{
    std::vector<float> image(64 * 64);
    unsigned state = 1;
    for (float &pixel : image) {
        state = state * 1664525u + 1013904223u;
        pixel = 0.05f + static_cast<float>(state >> 8) / 16777216.0f;
    }
    const sonject_measurement told = sonject::measure(context, {image.data(), 64, 64});
    expect(told.amplitude_contrast > 0.4 && told.amplitude_contrast < 0.7,
           "the contrast of uniform amplitudes, 1 / sqrt(3)");
    try {
        const std::vector<std::uint8_t> mask(3);
        sonject::measure(context, {image.data(), 64, 64}, mask);
        expect(false, "masks of another size throw");
    } catch (const sonject::error &) {
    }
    auto contact = sonject::defaults<sonject_contact_params>();
    contact.row_spacing_m = contact.column_spacing_m = 0.1;
    expect(sonject::measure_contact(context, {image.data(), 64, 64}, contact).seabed_db < 0.0,
           "the seabed's level");
}

static void check_files(const sonject::context &context)
{
    static const char text[] =
        "sonject: 1\ninput: {uniform: {rows: 4, columns: 5}, geometry: {row_spacing: 1, "
        "column_spacing: 1, first_slant_range: 40}}\n"
        "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
        "bands: {low: {}, high: {sonar: {frequency: 400e3}}}\n";
    std::FILE *file = std::fopen("bands.yaml", "w");
    expect(file && std::fputs(text, file) >= 0 && std::fclose(file) == 0, "a scene is written");
    const std::vector<std::string> both = {"low", "high"};
    expect(sonject::bands(context, "bands.yaml") == both, "bands are listed");
    expect(sonject::bands(context, "bands.yaml", {"band=low"}).empty(), "and chosen");
    expect(sonject::scene(context, "bands.yaml", {"band=high"}).object_count() == 0, "and read");
    try {
        auto forming = sonject::defaults<sonject_form_params>();
        forming.file = "bands.yaml";
        forming.folder = "formed";
        sonject::form(context, forming);
        expect(false, "what holds no impulses throws");
    } catch (const sonject::error &) {
    }
    try {
        auto merging = sonject::defaults<sonject_merge_params>();
        merging.folder = "merged";
        sonject::merge(context, merging);
        expect(false, "what holds no shards throws");
    } catch (const sonject::error &error) {
        expect(std::string(error.what()).find("shards") != std::string::npos, "and says so");
    }
    auto half = sonject::defaults<sonject_run_params>();
    half.folder = "shared";
    half.shard_index = 3;
    half.shard_count = 2;
    try {
        sonject::scene(context, "bands.yaml", {"band=low"}).run(half);
        expect(false, "a third half throws");
    } catch (const sonject::error &) {
    }
}

/* A transfer counts where it is said to be there. */
static void check_transfer(const sonject::context &context)
{
    auto seabed = sonject::defaults<sonject_seabed_file_params>();
    seabed.image = "swath.tif";
    seabed.synthetic.rows = seabed.synthetic.columns = 64;
    try {
        context.write_seabed(seabed);
    } catch (const sonject::error &error) {
        expect(error.status() == SONJECT_ERROR_UNSUPPORTED, "without image files alone");
        return;
    }
    auto measuring = sonject::defaults<sonject_measure_params>();
    auto contacts = sonject::defaults<sonject_contact_file_params>();
    contacts.image = measuring.image = "swath.tif";
    const sonject_measurement plain = sonject::measure(context, measuring);
    const std::string found = sonject::measure_contacts(context, contacts);
    contacts.transfer.kind = measuring.transfer.kind = SONJECT_TRANSFER_GAMMA;
    contacts.transfer.parameter = measuring.transfer.parameter = 0.0;
    expect(std::abs(sonject::measure(context, measuring).intensity_contrast -
                    plain.intensity_contrast) <= 0.0,
           "measures of plain amplitudes");
    expect(sonject::measure_contacts(context, contacts) == found, "and contacts");
    measuring.has_transfer = contacts.has_transfer = 1;
    int refused = 0;
    for (int number = 0; number < 2; number++)
        try {
            if (number == 0)
                sonject::measure(context, measuring);
            else
                sonject::measure_contacts(context, contacts);
        } catch (const sonject::error &error) {
            refused += error.status() == SONJECT_ERROR_INPUT;
        }
    expect(refused == 2, "transfers that are given are checked");
}

static void check_progress(const sonject::context &context)
{
    const std::vector<float> seabed(64 * 80, 0.1f);
    const sonject::scene scene = scene_with_ball(context);
    int calls = 0;
    sonject::inject(scene, {seabed.data(), 64, 80}, [&](double fraction, const char *stage) {
        calls += fraction >= 0.0 && fraction <= 1.0 && stage;
        return true;
    });
    expect(calls > 0, "progress is told");
    try {
        sonject::inject(scene, {seabed.data(), 64, 80}, [](double, const char *) { return false; });
        expect(false, "false cancels");
    } catch (const sonject::cancelled &) {
    }
    try {
        sonject::inject(scene, {seabed.data(), 64, 80}, [](double, const char *) -> bool {
            throw std::runtime_error("the caller's own");
        });
        expect(false, "what a callback throws comes out");
    } catch (const std::runtime_error &error) {
        expect(std::string(error.what()) == "the caller's own", "as it was thrown");
    }
}

int main()
{
    std::vector<std::string> lines;
    sonject::context_options options;
    options.log = [&](const char *line) { lines.push_back(line); };
    sonject::context made(options);
    sonject::context context = std::move(made);
    expect(!context.devices().empty(), "there are devices");
    expect(sonject::version().find('.') != std::string::npos, "the version");
    check_errors(context);
    check_results(context);
    check_tables(context);
    check_elements(context);
    check_measures(context);
    check_files(context);
    check_transfer(context);
    check_progress(context);
    expect(!lines.empty(), "news reach the log, also after the context has moved");
    if (failures == 0)
        std::puts("all right");
    return failures != 0;
}
