/* All of sonject's public interface. */
#ifndef SONJECT_SONJECT_H
#define SONJECT_SONJECT_H

#include <sonject/campaign.h>
#include <sonject/context.h>
#include <sonject/convert.h>
#include <sonject/elements.h>
#include <sonject/image.h>
#include <sonject/injection.h>
#include <sonject/material.h>
#include <sonject/measure.h>
#include <sonject/medium.h>
#include <sonject/motion.h>
#include <sonject/object.h>
#include <sonject/pulse.h>
#include <sonject/relief.h>
#include <sonject/result.h>
#include <sonject/run.h>
#include <sonject/scene.h>
#include <sonject/seabed.h>
#include <sonject/sonar.h>
#include <sonject/stages.h>
#include <sonject/status.h>
#include <sonject/surface.h>
#include <sonject/user_shape.h>
#include <sonject/version.h>

#endif
