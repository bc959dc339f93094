#include "cli/svg.h"

#include <stdbool.h>
#include <string.h>

const char *const zt_svg_hues[ZT_SVG_HUE_COUNT] = {"#d55e00", "#009e73", "#0072b2",
                                                   "#cc79a7", "#e69f00", "#56b4e9",
                                                   "#5b4b00", "#7f3c8d", "#555555"};

void zt_svg_begin(FILE *out, int width, int height) {
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "viewBox=\"0 0 %d %d\" font-family=\"DejaVu Sans,Verdana,sans-serif\">\n"
            "<style>.n{font-size:11px;font-weight:normal;fill:#59636e}"
            ".title{font-size:13px;font-weight:bold;fill:#1f2328}"
            ".end{text-anchor:end}.mid{text-anchor:middle}"
            "path{fill:none}.grid{stroke:#eceef1}.zero{stroke:#c9cfd6}"
            ".axis,.tick{stroke:#8b949e}.line{stroke-width:1.8;stroke-linejoin:round}"
            "circle{stroke:#fff;stroke-width:1}</style>\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
            width, height, width, height, width, height);
}

void zt_svg_number(FILE *out, double x) {
    char text[64];
    int length = snprintf(text, sizeof text, "%.2f", x);
    while (text[length - 1] == '0') text[--length] = '\0';
    if (text[length - 1] == '.') text[--length] = '\0';
    fputs(strcmp(text, "-0") == 0 ? "0" : text, out);
}

int zt_svg_letter_count(const char *text) {
    int count = 0;
    for (; *text; text++) count += ((unsigned char)*text & 0xC0) != 0x80;
    return count;
}

void zt_svg_words(FILE *out, const char *text, int most) {
    bool cut = zt_svg_letter_count(text) > most;
    for (int letters = 0; *text; text++) {
        unsigned char byte = (unsigned char)*text;
        if ((byte & 0xC0) != 0x80 && letters++ >= most - cut) break;
        if (byte == '&')
            fputs("&amp;", out);
        else if (byte == '<')
            fputs("&lt;", out);
        else if (byte < ' ' || byte == 0x7F)
            fputc('?', out);
        else
            fputc(byte, out);
    }
    if (cut) fputs("…", out);
}

void zt_svg_line(FILE *out, double x1, double y1, double x2, double y2, const char *class) {
    fprintf(out, "<path class=\"%s\" d=\"M", class);
    zt_svg_number(out, x1);
    fputc(' ', out);
    zt_svg_number(out, y1);
    fputc('L', out);
    zt_svg_number(out, x2);
    fputc(' ', out);
    zt_svg_number(out, y2);
    fputs("\"/>\n", out);
}
