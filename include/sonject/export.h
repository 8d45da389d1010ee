/* Visibility of the public functions. */
#ifndef SONJECT_EXPORT_H
#define SONJECT_EXPORT_H

#if defined(_WIN32) && defined(SONJECT_BUILDING_LIBRARY)
#define SONJECT_API __declspec(dllexport)
#elif defined(_WIN32)
#define SONJECT_API __declspec(dllimport)
#elif defined(__GNUC__)
#define SONJECT_API __attribute__((visibility("default")))
#else
#define SONJECT_API
#endif

#ifdef __cplusplus
#define SONJECT_BEGIN_DECLARATIONS extern "C" {
#define SONJECT_END_DECLARATIONS   }
#else
#define SONJECT_BEGIN_DECLARATIONS
#define SONJECT_END_DECLARATIONS
#endif

#endif
