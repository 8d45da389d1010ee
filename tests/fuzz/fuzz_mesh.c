/* Mesh files, from their bytes to a hierarchy. READER: stl_read, obj_read or ply_read. */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>

#include "mesh/mesh.h"
#include "mesh/mesh_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct report report = {{0}, NULL, NULL};
    struct mesh_soup soup = {.report = &report, .path = "fuzz"};
    struct mesh mesh = {0};
    char *text = fuzz_text(bytes, count);
    sonject_status status = READER(&soup, text, count);
    fuzz_expect(status, &report);
    if (status == SONJECT_OK) {
        for (size_t i = 0; i < 3 * soup.vertices; i++)
            if (!isfinite(soup.positions[i]))
                abort();
        for (size_t i = 0; i < 3 * soup.triangles; i++)
            if (soup.corners[i] >= soup.vertices)
                abort();
        mesh_options_init(&mesh.options);
        mesh.options.smooth_angle_rad = 0.5;
        status = mesh_of_soup(&soup, &mesh);
        fuzz_expect(status, &report);
        if (status == SONJECT_OK)
            fuzz_expect(mesh_require_closed(&report, "fuzz", &mesh), &report);
        mesh_clear(&mesh);
    }
    mesh_soup_clear(&soup);
    free(text);
    return 0;
}
