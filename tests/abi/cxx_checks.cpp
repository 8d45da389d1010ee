/* Checks of what sonject.hpp promises beyond the C interface. Prints "all right", or failures. */
#include <algorithm>
#include <cmath>
#include <cstdint>
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

/* Expects work to throw an error of this status, whose message has the words. */
template <typename Work>
static void expect_error(const char *what, sonject_status status, const char *words, Work work)
{
    try {
        work();
        expect(false, what);
    } catch (const sonject::error &error) {
        expect(error.status() == status &&
                   std::string(error.what()).find(words) != std::string::npos,
               what);
    }
}

static sonject::scene scene_with_ball(const sonject::context &context)
{
    sonject::scene scene = sonject::scene_of_text(
        context, "sonject: 1\n"
                 "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}\n"
                 "input: {geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, "
                 "first_slant_range: 30}}\n");
    scene.set("objects[0]", "{shape: sphere, diameter: 30 cm, material: steel}");
    expect(scene.object_count() == 1, "objects are counted");
    return scene;
}

static void check_errors(const sonject::context &context)
{
    sonject::scene scene = scene_with_ball(context);
    expect_error("unknown keys throw", SONJECT_ERROR_INPUT, "'altitude'",
                 [&] { scene.set("sonar.altitud", 3.0); });
    scene.set("sonar.altitude", 0.1);
    expect(scene.text().find("0.1000000000000000") != std::string::npos, "numbers keep digits");
    expect(std::stod(scene.get("sonar.altitude")) == 0.1, "what was set is read back");
    expect(scene.get("objects[0].material") == "\"steel\"", "texts as JSON");
    expect(scene.get("objects[1]") == "null", "what is not there is null");
    scene.set("injection.seed", UINT64_C(9007199254740993)); /* no double holds this number */
    expect(scene.get("injection.seed") == "9007199254740993", "whole numbers keep digits");
    scene.set("injection.interactions", 2);
    scene.set("injection.order_energies", true);
    expect(scene.get("injection.order_energies") == "true", "truths are words");
    expect(sonject_scene_object_count(scene.get(), nullptr) == SONJECT_ERROR_ARGUMENT &&
               std::string(sonject_context_message(context.get())).find("count") == 0,
           "the message is of the last failure");
    scene.set("sonar.altitude", -1.0);
    expect_error("bad values throw where the scene is used", SONJECT_ERROR_INPUT,
                 "set sonar.altitude: ", [&] { scene.object_count(); });
    expect_error("missing scene files throw", SONJECT_ERROR_INPUT, "there/is/none.yaml",
                 [&] { sonject::scene missing(context, "there/is/none.yaml"); });
    expect_error("texts that C would cut throw", SONJECT_ERROR_ARGUMENT, "",
                 [&] { scene.set("sonar.altitude", std::string("10 m\0 or so", 11)); });
    expect(sonject::keys(context).find("sonar.altitude") != std::string::npos, "keys are listed");
    expect(sonject::keys(context, SONJECT_KEYS_OF_CAMPAIGNS).find("chip.spread") !=
               std::string::npos,
           "those of campaigns, too");
    char *json = nullptr;
    expect(sonject_keys(context.get(), 2, &json) == SONJECT_ERROR_ARGUMENT && !json,
           "files of other kinds have none");
}

static void check_transfers(const sonject::context &context)
{
    const char *curve = "{kind: gamma, parameter: 2}";
    const std::vector<std::uint8_t> grey(64 * 80, 90);
    const std::vector<float> linear =
        sonject::convert_pixels<float>(context, {grey.data(), 64, 80, curve});
    expect(std::abs(linear[0] - 90.0f * 90.0f / 255.0f / 255.0f) < 1e-6f,
           "amplitudes of grey levels");
    expect(sonject::convert_pixels<std::uint8_t>(context, {linear.data(), 64, 80}, curve) == grey,
           "and grey levels of amplitudes");
    const sonject::scene scene = scene_with_ball(context);
    const sonject::result result = sonject::inject(scene, {grey.data(), 64, 80, curve});
    const std::vector<std::uint8_t> image = result.image<std::uint8_t>();
    const std::vector<std::uint8_t> changed = result.mask(SONJECT_LAYER_INFLUENCE);
    bool is_kept = image != grey;
    for (std::size_t i = 0; i < grey.size(); i++)
        is_kept = is_kept && (changed[i] != 0 || image[i] == grey[i]);
    expect(is_kept, "an image of grey levels has changed, but where the mask says so alone");
    expect_error("an image of grey levels is none of floats", SONJECT_ERROR_ARGUMENT, "",
                 [&] { result.image(); });
    expect_error(
        "grey levels without a transfer function throw", SONJECT_ERROR_ARGUMENT,
        "need their transfer function", [&] {
            sonject::inject(scene, {grey.data(), 64, 80, static_cast<const char *>(nullptr)});
        });
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
    expect_error("wrong sizes throw", SONJECT_ERROR_ARGUMENT, "bytes",
                 [&] { result.layer<float>(SONJECT_LAYER_ENERGY, small); });
}

/* Replaces a host's threads and runs the task on the caller's thread alone. */
static void run_tasks(void *calls, std::uint32_t count, sonject_task_function task, void *argument)
{
    *static_cast<std::uint32_t *>(calls) += count;
    task(argument);
}

static void check_threads(const sonject::context &context)
{
    const std::vector<float> seabed(64 * 80, 0.1f);
    std::uint32_t calls = 0;
    sonject::context_options options;
    options.device_name = "native";
    options.run_tasks = run_tasks;
    options.run_tasks_user = &calls;
    const sonject::context by_host(options);
    const sonject::scene here = scene_with_ball(context), there = scene_with_ball(by_host);
    expect(sonject::inject(here, {seabed.data(), 64, 80}).image() ==
               sonject::inject(there, {seabed.data(), 64, 80}).image(),
           "a host's threads make the same image");
    expect(calls > 0 || by_host.devices().front().compute_units == 1, "and are asked");
}

static void check_tables(const sonject::context &context)
{
    const std::vector<double> sway = {0.0, 1e-4, 1.0, 2e-4}, odd = {0.0, 1e-4, 1.0};
    const std::vector<double> heights = {0.0, 0.1, 0.0, 0.1, 0.0, 0.2};
    sonject::scene scene = scene_with_ball(context);
    scene.set_table("sonar.motion.file", "along_track_m, sway_m", sway);
    scene.set("seabed.relief[0].heights",
              "{unit: m, row_spacing: 5, column_spacing: 5, first_ground_range: 20}");
    scene.set_table("seabed.relief[0].heights.file", "", heights, 3);
    expect(scene.object_count() == 1, "tables are taken");
    expect_error("tables of other sizes throw", SONJECT_ERROR_ARGUMENT, "",
                 [&] { scene.set_table("sonar.motion.file", "along_track_m, sway_m", odd); });
}

static void check_elements(const sonject::context &context)
{
    const std::vector<float> seabed(32 * 40, 0.1f);
    sonject::scene scene = scene_with_ball(context);
    scene.set("elements.hydrophones.count", "2");
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
    const std::vector<std::uint8_t> mask(3);
    expect_error("masks of another size throw", SONJECT_ERROR_ARGUMENT, "", [&] {
        sonject::measure(context, {image.data(), 64, 64}, mask);
    });
    expect(sonject::measure_contact(context, {image.data(), 64, 64}, nullptr, 0.1, 0.1).seabed_db <
               0.0,
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
    auto forming = sonject::defaults<sonject_form_params>();
    forming.file = "bands.yaml";
    forming.folder = "formed";
    expect_error("what holds no impulses throws", SONJECT_ERROR_INPUT, "bands.yaml",
                 [&] { sonject::form(context, forming); });
    auto merging = sonject::defaults<sonject_merge_params>();
    merging.folder = "merged";
    expect_error("what holds no shards throws", SONJECT_ERROR_INPUT, "shards",
                 [&] { sonject::merge(context, merging); });
    auto half = sonject::defaults<sonject_run_params>();
    half.folder = "shared";
    half.shard_index = 3;
    half.shard_count = 2;
    expect_error("a third half throws", SONJECT_ERROR_ARGUMENT, "shard",
                 [&] { sonject::scene(context, "bands.yaml", {"band=low"}).run(half); });
}

/* The transfer function of a file is stated as in scenes. */
static void check_transfer(const sonject::context &context)
{
    sonject::scene seabed = scene_with_ball(context);
    seabed.set("input.synthetic", "{rows: 64, columns: 64}");
    try {
        seabed.write_seabed("swath.tif");
    } catch (const sonject::error &error) {
        expect(error.status() == SONJECT_ERROR_UNSUPPORTED, "without image files alone");
        return;
    }
    auto measuring = sonject::defaults<sonject_measure_params>();
    measuring.image = "swath.tif";
    const sonject_measurement plain = sonject::measure(context, measuring);
    expect_error("contacts need boxes", SONJECT_ERROR_ARGUMENT, "",
                 [&] { sonject::measure_contacts(context, measuring); });
    const sonject_box box = {0, 0, 8, 8};
    measuring.boxes = &box;
    measuring.box_count = 1;
    expect(sonject::measure_contacts(context, measuring).find("contacts") != std::string::npos,
           "contacts are measured");
    measuring.transfer = "{kind: gamma, parameter: 2}";
    expect(std::abs(sonject::measure(context, measuring).intensity_contrast -
                    plain.intensity_contrast) > 0.1,
           "a transfer counts");
    measuring.transfer = "{kind: gamma, parameter: 0}";
    expect_error("a transfer is checked", SONJECT_ERROR_INPUT, "",
                 [&] { sonject::measure(context, measuring); });
    expect_error("for contacts, too", SONJECT_ERROR_INPUT, "",
                 [&] { sonject::measure_contacts(context, measuring); });
    const std::vector<std::uint8_t> mask(64 * 64, 1);
    const std::vector<float> amplitudes(64 * 64, 0.1F);
    auto pixels = sonject::defaults<sonject_pixels>();
    pixels.data = amplitudes.data();
    pixels.rows = pixels.columns = 64;
    auto masked = sonject::defaults<sonject_measure_params>();
    masked.image = "swath.tif";
    masked.labels_mask = mask.data();
    expect_error("a mask of pixels is not of a file", SONJECT_ERROR_ARGUMENT, "",
                 [&] { sonject::measure(context, masked); });
    auto curved = sonject::defaults<sonject_measure_params>();
    curved.pixels = &pixels;
    curved.transfer = "{kind: decibel, parameter: 1}";
    expect_error("a file's transfer is not of pixels", SONJECT_ERROR_ARGUMENT, "",
                 [&] { sonject::measure(context, curved); });
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

static void check_campaigns(const sonject::context &context)
{
    sonject_campaign_fit_params fit = {};
    fit.struct_size = sizeof fit;
    fit.contacts = "contacts.csv";
    fit.fitted = "fitted.yaml";
    expect_error("a campaign that is not there is not fitted", SONJECT_ERROR_INPUT,
                 "no/campaign.yaml",
                 [&] { sonject::fit_campaign(context, "no/campaign.yaml", fit); });
}

int main()
{
    std::vector<std::string> lines;
    std::size_t notes = 0;
    sonject::context_options options;
    options.log = [&](sonject_log_level level, const char *line) {
        lines.push_back(line);
        notes += level == SONJECT_LOG_NOTE;
    };
    sonject::context made(options);
    sonject::context context = std::move(made);
    expect(!context.devices().empty(), "there are devices");
    expect(sonject::version().find('.') != std::string::npos, "the version");
    check_errors(context);
    check_results(context);
    check_transfers(context);
    check_threads(context);
    check_tables(context);
    check_elements(context);
    check_measures(context);
    check_files(context);
    check_transfer(context);
    check_progress(context);
    check_campaigns(context);
    expect(lines.size() > notes, "news reach the log, also after the context has moved");
    expect(notes > 0, "and notes as such");
    if (failures == 0)
        std::puts("all right");
    return failures != 0;
}
