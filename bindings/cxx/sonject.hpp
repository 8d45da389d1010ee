/* sonject for C++11 and later: the C interface with owners instead of releases, exceptions instead
 * of statuses, and views of memory that know their size. Header only; link with libsonject.
 *
 *     sonject::context context;
 *     sonject::scene scene(context);
 *     scene.set("sonar", "{frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}");
 *     scene.set("input.geometry",
 *               "{row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 44 m}");
 *     scene.set("objects[0]", "{shape: sphere, diameter: 0.5 m, material: steel}");
 *     sonject::result result = sonject::inject(scene, {pixels.data(), rows, columns});
 *     result.layer(SONJECT_LAYER_IMAGE, sonject::span<float>(pixels));
 *
 * Keys are those of scene files (tools/scenes/KEYS.md). Structures, units and meanings are those of
 * <sonject/...>. A failed call throws sonject::error with the library's message, or
 * sonject::cancelled if a progress callback asked to stop. Nothing is then changed, unless the C
 * function says so. An object of these classes belongs to one thread at a time, and must not
 * outlive the context that it was made with; moving a context is fine. */
#ifndef SONJECT_HPP
#define SONJECT_HPP

#include <sonject/campaign.hpp>
#include <sonject/context.hpp>
#include <sonject/elements.hpp>
#include <sonject/error.hpp>
#include <sonject/injection.hpp>
#include <sonject/measure.hpp>
#include <sonject/parameters.hpp>
#include <sonject/pixels.hpp>
#include <sonject/progress.hpp>
#include <sonject/scene.hpp>
#include <sonject/sonject.h>
#include <sonject/span.hpp>
#include <sonject/stages.hpp>
#include <sonject/text.hpp>

#endif
