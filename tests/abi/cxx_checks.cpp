/* What sonject.hpp promises beyond the C interface. Prints "all right", or what is not. */
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
    check_progress(context);
    expect(!lines.empty(), "news reach the log, also after the context has moved");
    if (failures == 0)
        std::puts("all right");
    return failures != 0;
}
