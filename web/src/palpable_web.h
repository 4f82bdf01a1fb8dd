/** @file
 * What the core for web pages has beside palpable.h and hands.h: a body from bytes, and how structs
 * lie in memory. palpable_load_body() and the functions of cameras are not in it.
 */
#ifndef PALPABLE_WEB_H
#define PALPABLE_WEB_H

#include "palpable/live/capi/hands.h"
#include "palpable/live/capi/palpable.h"

#ifdef __cplusplus
extern "C" {
#endif

/** As palpable_load_body(), from the bytes of a delivery file (palpable export --to web), which are
 * not needed afterwards. */
PALPABLE_API palpable_status palpable_read_body(const void* bytes, size_t count, double scale,
                                                palpable_body** body);

/** One JSON object for index.js, which so has no offset of its own: {"structs": {"palpable_touch":
 * {"size": 112, "members": {"point": 8, ...}}}, "constants": {"PALPABLE_REACHED": 1, ...}, "joints":
 * {"PALPABLE_WEBXR_HAND": 25, ...}}. Bytes from the beginning of the struct. */
PALPABLE_API const char* palpable_layout(void);

#ifdef __cplusplus
}
#endif

#endif /* PALPABLE_WEB_H */
