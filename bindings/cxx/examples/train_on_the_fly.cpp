/* A detector that learns from targets put into seabed on the fly. No image is stored: each step of
 * training sees a target in a new pose. The detector is as small as can be, a logistic regression
 * on four numbers of a window; the example shows how injection joins a training loop. It prints how
 * well the detector separates windows with and without a target, on new targets.
 *
 *     c++ train_on_the_fly.cpp $(pkg-config --cflags --libs sonject) && ./a.out
 */
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include <sonject.hpp>

namespace
{

constexpr std::uint32_t side = 128; /* pixels of a patch's side */
constexpr int features = 5;         /* the constant included */
using sample = std::array<double, features>;

/* Makes Rayleigh speckle; a real seabed would come from measured swaths. */
std::vector<float> make_seabed(std::mt19937 &random)
{
    std::normal_distribution<float> normal(0.0f, 0.05f);
    std::vector<float> amplitudes(side * side);
    for (float &amplitude : amplitudes)
        amplitude = std::hypot(normal(random), normal(random));
    return amplitudes;
}

sonject::scene make_scene(const sonject::context &context, std::mt19937 &random)
{
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    sonject::scene scene(context);
    scene.set("sonar", "{frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}");
    scene.set("input.geometry", "{row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 0}");
    scene.set("input.geometry.first_slant_range", 30.0 + 40.0 * unit(random));
    scene.set("injection.seed", std::to_string(random()));
    if (unit(random) < 0.5) {
        scene.set("objects[0].shape", "cylinder");
        scene.set("objects[0].length", 1.0 + unit(random));
        scene.set("objects[0].diameter", 0.4 + 0.4 * unit(random));
    } else {
        scene.set("objects[0].shape", "truncated_cone");
        scene.set("objects[0].height", "40 cm");
        const double diameter = 0.4 + 0.4 * unit(random);
        scene.set("objects[0].diameter", diameter);
        scene.set("objects[0].top_diameter", 0.5 * diameter);
    }
    scene.set("objects[0].heading", 360.0 * unit(random));
    scene.set("objects[0].burial", 0.1 * unit(random));
    return scene;
}

/* Returns levels of a window in dB: its brightest and darkest cell over the mean of the cells,
 * their spread, and that mean, each scaled to about 1. */
sample describe(const std::vector<float> &image)
{
    constexpr std::uint32_t cell = 4;
    double brightest = -200.0, darkest = 200.0, sum = 0.0, squares = 0.0;
    int cells = 0;
    for (std::uint32_t row = 0; row + cell <= side; row += cell)
        for (std::uint32_t column = 0; column + cell <= side; column += cell) {
            double energy = 1e-12;
            for (std::uint32_t i = 0; i < cell * cell; i++) {
                const float pixel = image[(row + i / cell) * side + column + i % cell];
                energy += static_cast<double>(pixel) * static_cast<double>(pixel);
            }
            const double level = 10.0 * std::log10(energy / (cell * cell));
            brightest = std::max(brightest, level);
            darkest = std::min(darkest, level);
            sum += level;
            squares += level * level;
            cells++;
        }
    const double mean = sum / cells;
    const double spread = std::sqrt(std::max(0.0, squares / cells - mean * mean));
    return {{1.0, (brightest - mean) / 10.0, (mean - darkest) / 10.0, spread / 3.0, mean / 30.0}};
}

double answer(const sample &weights, const sample &numbers)
{
    double sum = 0.0;
    for (int i = 0; i < features; i++)
        sum += weights[static_cast<std::size_t>(i)] * numbers[static_cast<std::size_t>(i)];
    return 1.0 / (1.0 + std::exp(-sum));
}

/* Describes one window, with or without a target. */
sample draw(const sonject::context &context, std::mt19937 &random, bool has_target)
{
    const std::vector<float> seabed = make_seabed(random);
    if (!has_target)
        return describe(seabed);
    const sonject::scene scene = make_scene(context, random);
    return describe(sonject::inject(scene, {seabed.data(), side, side}).image());
}

} // namespace

int main(int argument_count, char **)
{
    const int steps = argument_count > 1 ? 40 : 400; /* any argument: a short run */
    try {
        const sonject::context context;
        std::mt19937 training(1), testing(2);
        sample weights = {};
        for (int step = 0; step < steps; step++) {
            const bool has_target = step % 2 == 0;
            const sample numbers = draw(context, training, has_target);
            const double error = (has_target ? 1.0 : 0.0) - answer(weights, numbers);
            for (std::size_t i = 0; i < features; i++)
                weights[i] += 0.5 * error * numbers[i];
        }
        int right = 0;
        for (int step = 0; step < steps; step++)
            right +=
                (answer(weights, draw(context, testing, step % 2 == 0)) > 0.5) == (step % 2 == 0);
        std::printf("%d of %d unseen windows told right\n", right, steps);
        return 2 * right > steps ? 0 : 1;
    } catch (const sonject::error &failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return 1;
    }
}
