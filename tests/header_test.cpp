// Shows that a C++ program can include the public headers, link, and call what they declare.
// That each of them compiles alone, in C and in C++, the tests headers_c and headers_cpp show.
#include <zoetrope/zoetrope.h>

#include <cstring>

int main() {
    zt_image *none = nullptr;
    zt_image *image = nullptr;
    bool good = zt_image_create(&none, 0, 1) == ZT_EARGUMENT && !none &&
                zt_image_create(&image, 2, 1) == ZT_OK && image->pixels[7] == 1;
    zt_image_free(&image);

    char text[64];
    zt_message message = {};
    message.severity = ZT_ERROR;
    message.text = "x";
    good = good && zt_message_format(text, sizeof text, &message) == std::strlen(text) &&
           std::strcmp(text, "zoetrope: error: x") == 0 &&
           zt_rate_time(zt_rate{30000, 1001}, 30000) == 1001;
    return good ? 0 : 1;
}
