/* Where the library's own modules and programs lie. */
#ifndef SONJECT_BASE_MODULE_PATH_H
#define SONJECT_BASE_MODULE_PATH_H

/* The path of the file of that name: in the folder sonject beside the library (beside the program,
 * where the library is part of it); right beside it, as in Python's package and where it was built;
 * or where sonject was installed. Tests are told where (MODULE_FOLDER). To be given to free(); NULL
 * when memory is out. */
char *module_path(const char *name);

#endif
