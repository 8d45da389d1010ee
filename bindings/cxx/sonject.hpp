/* sonject for C++11 and later: the C interface with owners instead of releases, exceptions instead
 * of statuses, and views of memory that know their size. Header only; link with libsonject.
 *
 *     sonject::context context;
 *     sonject::scene scene(context);
 *     auto geometry = sonject::defaults<sonject_geometry_params>();
 *     geometry.first_slant_range_m = 44.0;
 *     scene.set(geometry);
 *     auto ball = sonject::defaults<sonject_object_params>();
 *     ball.shape = SONJECT_SHAPE_SPHERE;
 *     ball.diameter_m = 0.5;
 *     scene.add(ball);
 *     sonject::result result = sonject::inject(scene, {pixels.data(), rows, columns});
 *     result.layer(SONJECT_LAYER_IMAGE, sonject::span<float>(pixels));
 *
 * Structures, units, ranges and meanings are those of <sonject/...>. What fails throws
 * sonject::error (sonject::cancelled where a progress callback asked to stop) with the library's
 * message; nothing is then changed unless the C function says so. An object of these classes
 * belongs to one thread at a time, and must not outlive the context that it was made with; moving a
 * context is fine. */
#ifndef SONJECT_HPP
#define SONJECT_HPP

#include <sonject/campaign.hpp>
#include <sonject/context.hpp>
#include <sonject/elements.hpp>
#include <sonject/error.hpp>
#include <sonject/injection.hpp>
#include <sonject/measure.hpp>
#include <sonject/parameters.hpp>
#include <sonject/progress.hpp>
#include <sonject/scene.hpp>
#include <sonject/scene_content.hpp>
#include <sonject/sonject.h>
#include <sonject/span.hpp>
#include <sonject/stages.hpp>
#include <sonject/text.hpp>

#endif
