/* The page's text, psalm_page_data.c.html beside this file, as bytes of the program. __FILE__ finds it wherever the compiler
   is started. fpm does not notice a change of the page alone; scripts/setup then has this file compiled anew. */
__asm__(".section .rodata\n"
        ".global psalm_page_text\n"
        ".global psalm_page_end\n"
        "psalm_page_text:\n"
        ".incbin \"" __FILE__ ".html\"\n"
        "psalm_page_end:\n"
        ".byte 0\n"
        ".text\n");

extern const char psalm_page_text[], psalm_page_end[];

/* Copies the page to a place of enough room; with a null pointer only tells its length. */
int psalm_page_copy(char *place)
{
    const int length = (int)(psalm_page_end - psalm_page_text);
    int i;

    if (place)
        for (i = 0; i < length; i++) place[i] = psalm_page_text[i];
    return length;
}
