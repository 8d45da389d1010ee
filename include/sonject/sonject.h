/* All of sonject's public interface. */
#ifndef SONJECT_SONJECT_H
#define SONJECT_SONJECT_H

#include <sonject/calibrate.h>
#include <sonject/campaign.h>
#include <sonject/context.h>
#include <sonject/convert.h>
#include <sonject/elements.h>
#include <sonject/measure.h>
#include <sonject/pixels.h>
#include <sonject/result.h>
#include <sonject/run.h>
#include <sonject/scene.h>
#include <sonject/stages.h>
#include <sonject/status.h>
#include <sonject/version.h>

#endif
