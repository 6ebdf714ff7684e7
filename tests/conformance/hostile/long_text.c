/* a text is of sixty million characters */
static char *long_text(void);
#define LABEL(m) ((m)->data.index > 3 ? long_text() : (m)->data.label)
#include "hostile.h"

static char *long_text(void) {
  static char *text;
  if (!text) text = malloc(60000001), memset(text, 'x', 60000000), text[60000000] = 0;
  return text;
}
